// How the single layer of prisms between front and wall is subdivided: cells per front face, points per front vertex,
// and the heights. Where walls ask for different counts, and where some stacks have room for a cell over their layers,
// the counts of faces that share an edge differ by one at most.
//
//      front  o-------o-------o-------o      cells of the stacks: 1, 2, 3
//             |       |       |       |      The vertical edge between two stacks has the points of the higher one; cells
//             |       |       o-------o      at the wall are level with their neighbours, the innermost takes the rest.
//             |       o-------o-------o
//      wall   o-------o-------o-------o
#pragma once
#include "i2b/front/front.h"
#include "i2b/front/wanted_room.h"
#include "i2b/geometry/surface.h"
#include "i2b/layers/columns.h"
#include "i2b/layers/layer_plan.h"
#include <cstdint>
#include <string>
#include <vector>

namespace i2b {

// The plans of all walls: that of walls without a rule of their own first.
struct WallPlans {
    std::vector<LayerPlan> plans;
    std::vector<std::uint16_t> ofPart;       // per part, into plans; empty: the first plan for all
    std::vector<std::string> notes;          // rules that mean no part
};
// Throws Error(usage) where a name is no regular expression or there are more than 65535 rules.
WallPlans plansOf(const LayerOptions& options, const std::vector<Part>& parts);
RoomOfWalls roomWanted(const WallPlans& plans); // most: of the plans that a part has

// Points of a vertex run from the front, which is a point of the kept cells and not counted, to the wall; cells of a face
// from the front to the wall too.
struct LayerStack {
    std::vector<LayerPlan> plans;            // as WallPlans::plans
    std::size_t faces = 0, vertices = 0;
    int count = 1;                           // cells of every stack where all are alike, else of the highest
    // Where not all stacks are alike; else empty:
    std::vector<std::uint32_t> cellOffsets;  // per face and one more
    std::vector<std::uint32_t> pointOffsets; // per vertex and one more
    // Where there are several plans; else empty:
    std::vector<std::uint16_t> facePlan, vertexPlan;
    // Where heights are in cell sizes; else empty:
    std::vector<float> cellSize;             // m, per vertex
    // Per vertex; empty: all straight.
    std::vector<Column> columns;
    double leastShare = 1;                   // of the room, that the lowest cells take on average where the plan is that leaves them least

    bool uniform() const { return cellOffsets.empty(); }
    int cellsOf(std::size_t face) const { return uniform() ? count : static_cast<int>(cellOffsets[face + 1] - cellOffsets[face]); }
    int pointsOf(std::size_t vertex) const { return uniform() ? count : static_cast<int>(pointOffsets[vertex + 1] - pointOffsets[vertex]); }
    // Are there cells that are to be thin? Not where few share the room.
    bool areThin() const;
    // Even so thin that small determinants and weights are to be? Else they are to be as good as other cells.
    bool areFlat() const;
    // Where the cells of a face and the points of a vertex begin among those of all.
    std::size_t cellOffset(std::size_t face) const { return uniform() ? face * static_cast<std::size_t>(count) : cellOffsets[face]; }
    std::size_t pointOffset(std::size_t vertex) const { return uniform() ? vertex * static_cast<std::size_t>(count) : pointOffsets[vertex]; }
    std::size_t cells() const { return cellOffset(faces); }
    std::size_t points() const { return pointOffset(vertices); }
    std::size_t vertexOfPoint(std::size_t point) const; // that has the point of this number among those of all
    std::size_t faceOfCell(std::size_t cell) const;     // that has the cell of this number among those of all

    const LayerPlan& planOfFace(std::size_t face) const { return plans[facePlan.empty() ? 0 : facePlan[face]]; }
    const LayerPlan& planOfVertex(std::size_t vertex) const { return plans[vertexPlan.empty() ? 0 : vertexPlan[vertex]]; }
    // Distances of a vertex' points from the wall in m where front and wall are `room` apart, pointsOf(vertex) of them,
    // falling to 0.
    void heights(std::size_t vertex, double room, double* out) const;

    // "" or the first fault: sizes, a vertex without the points that the faces around it need, neighbours that differ by
    // more than a cell, points that do not fall to the wall.
    std::string validate(const Front& front) const;
};

// With straight columns: see bendColumns().
LayerStack makeLayers(const Front& front, const WallPlans& plans);
LayerStack makeLayers(const Front& front, const LayerOptions& options); // the same on all parts

// Lowers counts, per face of the mesh, as little as it takes for those of faces that share an edge to differ by one at
// most: each is then the least of count and distance over all faces, whatever the order they are visited in.
void taperCounts(const FrontMesh& mesh, std::vector<std::uint8_t>& counts);

// The points of one front vertex' stack, from the front position to the wall position: layers.pointsOf(vertex) of them
// into out, the last at the wall. The one place that knows where they are, whatever becomes of the two positions.
void placeLayers(const LayerStack& layers, std::size_t vertex, const Vec3& front, const Vec3& wall, Vec3* out);
// The same where its heights() are known.
void placeLayers(const LayerStack& layers, std::size_t vertex, const Vec3& front, const Vec3& wall, const double* heights, Vec3* out);

// m, from the front to the wall position of a vertex.
double roomAt(const Front& front, std::size_t vertex);

} // namespace i2b
