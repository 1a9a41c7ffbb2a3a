// The nodes of an assembled mesh that may be moved after the fit, and what hangs on them: a front point carries the
// points of the layers of its fans and of vertices put into its edges, a wall point those of its own stack; of a vertex put into an
// edge its front point, too.
#pragma once
#include "i2b/assemble/assemble.h"
#include <cstdint>
#include <utility>
#include <vector>

namespace i2b {

struct MeshNode {
    enum Kind : std::uint8_t { core, front, wall };
    Kind kind = core;
    std::int32_t id = 0; // core: place in Front::movedPoints; front: core point; wall: vertex of the front
    friend auto operator<=>(const MeshNode&, const MeshNode&) = default;
};

// Per mesh point, of so many: does it hang on such a node?
std::vector<std::uint8_t> mayMove(const Front& front, std::size_t points);

class MeshNodes {
  public:
    using Moved = std::vector<std::pair<std::int32_t, Vec3>>; // mesh points and where they go
    // Keeps references; moveTo() changes front.
    MeshNodes(Front& front, const LayerStack& layers);

    std::int32_t corePoints() const { return core_; } // mesh points from here on are those of layers
    std::size_t vertexOf(std::int32_t layerPoint) const { return layers_.vertexOfPoint(static_cast<std::size_t>(layerPoint - core_)); }
    // The nodes that a mesh point hangs on; appends none for a fixed one.
    void nodesOf(std::int32_t point, std::vector<MeshNode>& out) const;
    Vec3 place(const MeshNode& node) const;  // m
    double h(const MeshNode& node) const;    // m, size of the cells around
    std::uint8_t outside(const MeshNode& node) const; // as Front::outside
    // The wall vertices over a front node.
    std::pair<const std::int32_t*, const std::int32_t*> fansOf(std::int32_t corePoint) const;
    std::int32_t movedPlace(std::int32_t point) const; // in Front::movedPoints, or -1
    // Where all mesh points that hang on the node go with it.
    void follow(const MeshNode& node, const Vec3& to, Moved& out) const;
    void moveTo(const MeshNode& node, const Vec3& to);

  private:
    struct Fan { std::int32_t point, vertex; friend auto operator<=>(const Fan&, const Fan&) = default; };
    struct Child { std::int32_t parent, vertex; friend auto operator<=>(const Child&, const Child&) = default; };
    void stack(std::int32_t vertex, const Vec3& front, const Vec3& wall, Moved& out) const;
    Vec3 frontUnder(std::int32_t vertex, const Vec3& wall) const;

    Front& front_;
    const LayerStack& layers_;
    std::int32_t core_; // points of the kept cells
    RawVector<std::int32_t> points_, vertices_; // fans by core point
    std::vector<Child> children_;                 // inserted vertices by the ends of their edge
    struct MovedPoint { std::int32_t point, place; friend auto operator<=>(const MovedPoint&, const MovedPoint&) = default; };
    RawVector<MovedPoint> moved_;                 // by core point, with its place in Front::movedPoints
};

} // namespace i2b
