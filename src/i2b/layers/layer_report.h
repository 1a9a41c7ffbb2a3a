// What became of the layers asked for: per wall face, per part and on the whole. Measured on the front as it is, after
// the last of its points has moved.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace i2b {

struct Front;
struct LayerStack;
struct Part;

// Why a wall face falls short of what is asked.
enum class LayerCause : std::uint8_t {
    none,       // it does not, or has no layers to carry
    taper,      // neighbours have fewer layers: so has it
    compressed, // too little room for the thickness: less growth, but the first height
    room,       // too little room for the first height, too: all heights are less
    merged      // cells of its stack are one, since no other way brought them within the limits of quality
};
constexpr std::array<const char*, 5> layerCauseNames{"none", "taper", "compressed", "room", "merged"};

// Per wall face, in the order of the front. Heights are means over a face's vertices.
struct WallLayers {
    std::vector<std::int32_t> wallCell;  // number of the cell at the wall among the layer cells of all; ascending
    std::vector<std::uint8_t> asked;     // layers
    std::vector<std::uint8_t> achieved;  // a cell that takes the rest of the room is none
    std::vector<LayerCause> cause;
    std::vector<float> first;            // m, height of the cell at the wall
    std::vector<float> thickness;        // m, of the layers achieved
    std::vector<float> askedFirst, askedThickness; // m; 0 where none are asked for
    std::vector<std::uint8_t> pieces;    // faces of the mesh that it is now; empty: one each
};

struct LayerRow {
    std::string part;
    int asked = 0;                       // layers
    double askedFirst = 0, askedThickness = 0; // m, means over the faces
    double meanCount = 0;                // achieved
    double meanFirst = 0, meanThickness = 0;   // m, over the faces that have layers
    std::int64_t faces = 0;
    std::array<std::int64_t, 5> causes{};      // faces, by LayerCause
};

struct LayerReport {
    int requested = 0;                   // prism layers asked for on walls without a rule of their own
    double meanCount = 0;                // layers achieved, mean over the wall faces
    double facesCoveredFraction = 0;     // wall faces with at least one layer
    double thicknessFraction = 0;        // achieved over asked thickness, at most 1, mean over the faces that ask for layers
    double meanFirst = 0, minFirst = 0, maxFirst = 0; // m, of the faces with layers
    std::vector<LayerRow> parts{};       // that have wall faces, in the order of the geometry
};

WallLayers measureLayers(const Front& front, const LayerStack& stack);
// After cells of the mesh have become one: cellOf gives per cell of before its number now, layers from firstLayerCell on;
// empty: nothing has changed. morePieces: cells of before, ascending, one for each face that the wall has got there. Wall cells
// become cells of the mesh.
void settleCells(WallLayers& walls, const LayerStack& stack, std::int32_t firstLayerCell, const std::vector<std::int32_t>& cellOf,
                 const std::vector<std::int32_t>& morePieces);
// Faces of the wall that are gone: cells of the mesh, one for each.
void dropFaces(WallLayers& walls, const std::vector<std::int32_t>& cells);
// cellOf: per cell of the mesh its number from now on; empty: all stay.
void renumber(WallLayers& walls, const std::vector<std::int32_t>& cellOf);
// In the order of cells, each cell once: of several faces at one the first.
void sortByCell(WallLayers& walls);
LayerReport summarize(const WallLayers& walls, const Front& front, const std::vector<Part>& parts, int requested);

} // namespace i2b
