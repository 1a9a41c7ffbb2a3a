#include "i2b/program/settings.h"
#include <algorithm>
#include <array>
#include <numeric>

namespace i2b {
namespace {

using Texts = std::vector<std::string>;

#define I2B_FIELD(type, member) FieldOf<type>([](Case& c) -> type& { return c.member; })

const std::array table{
    Setting{"geometry", "FILE...", "Files of triangles; in a case file, relative to its folder",
            I2B_FIELD(Texts, options.geometry.files)},
    Setting{"scale", "S", "Metres per unit of the geometry files; every other length is in metres after it",
            I2B_FIELD(double, options.geometry.scale)},
    Setting{"size", "D", "Largest cell that meets the geometry, m; the only length ever required",
            I2B_FIELD(double, options.size.surface), "size", "surface"},
    Setting{"max-size", "D", "Largest cell anywhere, m; 0: from the extent of the domain",
            I2B_FIELD(double, options.size.max), "size", "max"},
    Setting{"min-size", "D", "Smallest cell, and the size of holes that are closed, m; 0: half of size",
            I2B_FIELD(double, options.size.min), "size", "min"},
    Setting{"part-size", "PART=D", "Largest cell that meets a part (whole name or regular expression), m",
            I2B_FIELD(std::vector<PartSize>, options.size.parts), "size", "part"},
    Setting{"box-size", "X0 Y0 Z0 X1 Y1 Z1 D", "Largest cell inside a box, m",
            I2B_FIELD(std::vector<BoxSize>, options.size.boxes), "size", "box"},
    Setting{"sphere-size", "X Y Z R D", "Largest cell inside a sphere, m",
            I2B_FIELD(std::vector<SphereSize>, options.size.spheres), "size", "sphere"},
    Setting{"cylinder-size", "X0 Y0 Z0 X1 Y1 Z1 R D", "Largest cell inside a cylinder with flat ends, m",
            I2B_FIELD(std::vector<CylinderSize>, options.size.cylinders), "size", "cylinder"},
    Setting{"band-size", "PART DISTANCE D", "Largest cell within a distance of a part, m",
            I2B_FIELD(std::vector<BandSize>, options.size.bands), "size", "band"},
    Setting{"point-size", "X Y Z D", "Largest cell that holds a point, m",
            I2B_FIELD(std::vector<PointSize>, options.size.points), "size", "point"},
    Setting{"segment-size", "X0 Y0 Z0 X1 Y1 Z1 D", "Largest cell that a line segment meets, m",
            I2B_FIELD(std::vector<SegmentSize>, options.size.segments), "size", "segment"},
    Setting{"line-size", "X Y Z DX DY DZ D", "Largest cell that an endless line through X Y Z meets, m",
            I2B_FIELD(std::vector<LineSize>, options.size.lines), "size", "line"},
    Setting{"curvature", "N", "Cells per 360 degrees along curved walls, down to min-size; 0: off",
            I2B_FIELD(double, options.size.curvature), "size", "curvature"},
    Setting{"gap-cells", "N", "Cells between opposite walls, down to min-size; 0: off",
            I2B_FIELD(int, options.size.gapCells), "size", "gap-cells"},
    Setting{"buffer-cells", "N", "Cells of each size between the next finer and the next coarser",
            I2B_FIELD(int, options.size.bufferCells), "size", "buffer-cells"},
    Setting{"box", "X0 Y0 Z0 X1 Y1 Z1", "The domain, m; without it, a box from the extent of the geometry",
            I2B_FIELD(std::optional<Box>, options.domain.box)},
    Setting{"external", "", "Mesh what lies around the geometry, up to the box; the default without seeds",
            FlowChoice{Flow::external}},
    Setting{"internal", "", "Mesh what the geometry encloses", FlowChoice{Flow::internal}},
    Setting{"seed", "[NAME=]X,Y,Z | X Y Z", "A place in the flow, m, and the name of its zone; repeatable",
            I2B_FIELD(std::vector<Seed>, options.domain.seeds)},
    Setting{"keep-out", "[NAME=]X,Y,Z | X Y Z", "A place that the flow must not reach, m: where it would, nothing is meshed and the openings on its way are told; repeatable",
            I2B_FIELD(std::vector<Seed>, options.domain.keepOut)},
    Setting{"feature-angle", "DEG",
            "Angle between two triangles above which their edge is kept sharp; 180: none",
            I2B_FIELD(double, options.geometry.featureAngle), "feature", "angle"},
    Setting{"crease-angle", "DEG",
            "Least fold that the wall follows where no kept edge is near; smaller: nearer to round walls, which are less smooth quadrilaterals; 180: none",
            I2B_FIELD(double, options.geometry.creaseAngle), "feature", "crease-angle"},
    Setting{"feature-lines", "FILE",
            "OBJ file whose lines (l) are kept as edges and whose points (p) as corners; repeatable",
            RepeatedTexts{I2B_FIELD(Texts, options.geometry.featureLines)}, "feature", "lines"},
    Setting{"feature-part", "PART",
            "Part (whole name or regular expression) whose free edges and borders are kept; repeatable",
            RepeatedTexts{I2B_FIELD(Texts, options.geometry.featureParts)}, "feature", "part"},
    Setting{"feature-box", "X0 Y0 Z0 X1 Y1 Z1 all|none",
            "Box, m, in which all edges over 1 degree are kept sharp, or none; the last one counts",
            I2B_FIELD(std::vector<FeatureBox>, options.geometry.featureBoxes), "feature", "box"},
    Setting{"clearance", "F", "Room between the Cartesian cells and the geometry, in cell edges",
            I2B_FIELD(double, options.fit.clearance), "fit", "clearance"},
    Setting{"sweeps", "N", "Sweeps of smoothing and projection of the wall",
            I2B_FIELD(int, options.fit.sweeps), "fit", "sweeps"},
    Setting{"fit-seconds", "S",
            "Time after which the fit begins no further sweep; the mesh then depends on the machine; 0: no limit",
            I2B_FIELD(double, options.fit.seconds), "fit", "seconds"},
    Setting{"layers", "N", "Prism layers on every wall face; 0: none",
            I2B_FIELD(int, options.layers.count), "layer", "count"},
    Setting{"first-layer", "H", "Height of the layer at the wall, m; 0: from layer-thickness, else from the room",
            I2B_FIELD(double, options.layers.first), "layer", "first"},
    Setting{"layer-thickness", "T", "Height of all layers together, m; 0: from first-layer, else all the room",
            I2B_FIELD(double, options.layers.thickness), "layer", "thickness"},
    Setting{"growth", "R", "Ratio of the heights of a layer and the next towards the wall; 0: from the heights, else 1.2",
            I2B_FIELD(double, options.layers.growth), "layer", "growth"},
    Setting{"layer-unit", "m|cell", "Unit of the two heights: metres, or the size of the cells at the place",
            I2B_FIELD(LayerUnit, options.layers.unit), "layer", "unit"},
    Setting{"part-layers", "PART=N[,first=H][,thickness=T][,growth=R]",
            "Layers on a part (whole name or regular expression); N none: no layers; what is left out as for all",
            I2B_FIELD(std::vector<PartLayers>, options.layers.parts), "layer", "part"},
    Setting{"y-plus", "Y", "y+ at the centre of the cell at the wall, gives first-layer; 0: first-layer as it is",
            I2B_FIELD(double, options.layers.yPlus), "layer", "y-plus"},
    Setting{"velocity", "U", "Of the flow, m/s; for y-plus", I2B_FIELD(double, options.layers.velocity), "layer", "velocity"},
    Setting{"viscosity", "NU", "Kinematic viscosity, m2/s; for y-plus",
            I2B_FIELD(double, options.layers.viscosity), "layer", "viscosity"},
    Setting{"length", "L", "Of the body along the flow, m; for y-plus", I2B_FIELD(double, options.layers.length), "layer", "length"},
    Setting{"max-non-orthogonality", "DEG", "Limit of check: line between cells to their face's normal; 180: not asked",
            I2B_FIELD(double, options.quality.nonOrthogonality), "quality", "max-non-orthogonality"},
    Setting{"min-pyramid-volume", "V", "Limit of check: pyramid of a face with a cell's centre, m3; -1e30: not asked",
            I2B_FIELD(double, options.quality.pyramidVolume), "quality", "min-pyramid-volume"},
    Setting{"min-tet-quality", "Q", "Limit of check: tetrahedra of faces with cells, 1: regular; -1e30: not asked",
            I2B_FIELD(double, options.quality.tetQuality), "quality", "min-tet-quality"},
    Setting{"max-concavity", "DEG", "Limit of check: inward corners of faces; 180: not asked",
            I2B_FIELD(double, options.quality.concavity), "quality", "max-concavity"},
    Setting{"min-face-area", "A", "Limit of check: area of faces, m2; -1: not asked",
            I2B_FIELD(double, options.quality.faceArea), "quality", "min-face-area"},
    Setting{"max-internal-skewness", "S", "Limit of check: skewness of inner faces; -1 here and below: not asked",
            I2B_FIELD(double, options.quality.internalSkewness), "quality", "max-internal-skewness"},
    Setting{"max-boundary-skewness", "S", "Limit of check: skewness of boundary faces",
            I2B_FIELD(double, options.quality.boundarySkewness), "quality", "max-boundary-skewness"},
    Setting{"min-face-weight", "W", "Limit of check: nearer share of the distance between cells, 0.5 at most; -1: not asked",
            I2B_FIELD(double, options.quality.faceWeight), "quality", "min-face-weight"},
    Setting{"min-volume-ratio", "R", "Limit of check: smaller over larger of two neighbours; -1: not asked",
            I2B_FIELD(double, options.quality.volumeRatio), "quality", "min-volume-ratio"},
    Setting{"min-twist", "COS", "Limit of check: triangles of a face to the line between its cells; -1: not asked",
            I2B_FIELD(double, options.quality.twist), "quality", "min-twist"},
    Setting{"min-triangle-twist", "COS", "Limit of check: triangles of a face to the next; -1: not asked",
            I2B_FIELD(double, options.quality.triangleTwist), "quality", "min-triangle-twist"},
    Setting{"min-flatness", "F", "Limit of check: areas of a face's triangles over its own; -1: not asked",
            I2B_FIELD(double, options.quality.flatness), "quality", "min-flatness"},
    Setting{"min-determinant", "D", "Limit of check: of cells, by the areas of their faces, 1: a cube; -1: not asked",
            I2B_FIELD(double, options.quality.determinant), "quality", "min-determinant"},
    Setting{"format", "F,F,...", "What to write: openfoam, vtu, ply, vdb, report",
            I2B_FIELD(Texts, options.output.formats)},
    Setting{"ascii", "", "Write the OpenFOAM mesh as text instead of binary",
            I2B_FIELD(bool, options.output.ascii)},
    Setting{"out", "DIR", "Folder for the results", I2B_FIELD(std::string, options.output.folder)},
    Setting{"threads", "N", "Threads to use; 0: all the machine has", I2B_FIELD(int, options.threads)},
    Setting{"quiet", "", "Print nothing but errors and what was asked for", I2B_FIELD(bool, quiet)},
};

#undef I2B_FIELD

// Levenshtein's distance, one row at a time.
std::size_t editDistance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t(0));
    for (std::size_t i = 0; i < a.size(); ++i) {
        std::size_t diagonal = row[0]++;
        for (std::size_t j = 0; j < b.size(); ++j) {
            const std::size_t substituted = diagonal + (a[i] != b[j]);
            diagonal = row[j + 1];
            row[j + 1] = std::min({substituted, row[j] + 1, row[j + 1] + 1});
        }
    }
    return row.back();
}

} // namespace

std::span<const Setting> settings() { return table; }

const Setting* findSetting(std::string_view key) {
    const auto* const found = std::ranges::find(table, key, &Setting::key);
    return found == table.end() ? nullptr : found;
}

bool isTable(std::string_view name) {
    return !name.empty() && std::ranges::find(table, name, &Setting::table) != table.end();
}

const Setting* findInTable(std::string_view name, std::string_view key) {
    const auto* const found = std::ranges::find_if(
        table, [&](const Setting& s) { return !key.empty() && s.table == name && s.inTable == key; });
    return found == table.end() ? nullptr : found;
}

namespace {

// nameOf(setting): empty where it is no candidate.
template <class NameOf>
std::string_view nearest(std::string_view key, const NameOf& nameOf) {
    std::string_view best;
    std::size_t least = key.size() + 99;
    for (const Setting& setting : table) {
        const std::string_view name = nameOf(setting);
        const std::size_t distance = name.empty() ? least : editDistance(name, key);
        if (distance < least) best = name, least = distance;
    }
    return least <= std::max<std::size_t>(2, key.size() / 3) ? best : std::string_view{};
}

} // namespace

std::string_view nearestKey(std::string_view key) { return nearest(key, [](const Setting& s) { return s.key; }); }
std::string_view nearestInTable(std::string_view name, std::string_view key) {
    return nearest(key, [&](const Setting& s) { return s.table == name ? s.inTable : std::string_view{}; });
}

} // namespace i2b
