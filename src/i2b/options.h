// All options of a run: plain aggregates with a default and the unit on every field. They are validated in one
// place (program/options.cpp, validate()) before any stage sees them.
#pragma once
#include "i2b/core/vec.h"
#include "i2b/quality/dictionary_limits.h"
#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace i2b {

enum class BoxEdges : std::uint8_t { none, all };

struct FeatureBox {
    Box box;                             // m
    BoxEdges edges = BoxEdges::none;     // all: edges of over one degree inside are features; none: no edge is
};

struct GeometryOptions {
    std::vector<std::string> files;
    double scale = 1;                    // file unit to metres
    double featureAngle = 40;            // degrees; 180: no features but those named below
    double creaseAngle = 6;              // degrees; folds over it, but not over featureAngle, that the wall follows; 180: none
    std::vector<std::string> featureLines{}; // OBJ files of lines and corners, in the unit of the geometry
    std::vector<std::string> featureParts{}; // names or regular expressions (whole name): their free edges and borders
    std::vector<FeatureBox> featureBoxes{};  // of boxes that overlap the last one counts
};

// One size for all axes.
constexpr Vec3 sameSize(double size) { return {size, size, size}; }

struct PartSize {
    std::string part;                    // name or regular expression (whole name)
    Vec3 size;                           // m, largest cell that may meet it, along each axis
};

struct BoxSize {
    Box box;                             // m
    Vec3 size;                           // m, largest cell inside, along each axis
};

struct SphereSize {
    Vec3 centre;                         // m
    double radius = 0;                   // m
    Vec3 size;                           // m, largest cell inside, along each axis
};

struct CylinderSize {
    Vec3 from, to;                       // m, centres of its flat ends
    double radius = 0;                   // m
    Vec3 size;                           // m, largest cell inside, along each axis
};

struct BandSize {
    std::string part;                    // name or regular expression (whole name)
    double distance = 0;                 // m, to both sides of the part
    Vec3 size;                           // m, largest cell that near, along each axis
};

struct PointSize {
    Vec3 place;                          // m
    Vec3 size;                           // m, largest cell that holds it, along each axis
};

struct SegmentSize {
    Vec3 from, to;                       // m
    Vec3 size;                           // m, largest cell that it meets, along each axis
};

struct LineSize {
    Vec3 through;                        // m
    Vec3 direction;                      // of any length; the line has no ends
    Vec3 size;                           // m, largest cell that it meets, along each axis
};

struct SizeOptions {
    double surface = 0;                  // m, d_int: the largest cell that meets the geometry; the only one required
    double max = 0;                      // m, d_max: the largest cell anywhere; 0: from the extent
    double min = 0;                      // m, d_min: the smallest; 0: surface / 2
    std::vector<PartSize> parts;
    std::vector<BoxSize> boxes;
    std::vector<SphereSize> spheres;
    std::vector<CylinderSize> cylinders;
    std::vector<BandSize> bands;
    std::vector<PointSize> points;
    std::vector<SegmentSize> segments;
    std::vector<LineSize> lines;
    double curvature = 0;                // cells per 360 degrees along a curved wall; 0: off
    int gapCells = 0;                    // cells between opposite walls, down to the smallest cell; 0: off
    int bufferCells = 3;                 // cells of each level between the next finer and the next coarser
};

enum class Flow : std::uint8_t { automatic, external, internal };

struct Seed {
    std::string name;                    // of the zone; may be empty
    Vec3 place;                          // m
};

struct DomainOptions {
    std::optional<Box> box;              // m; else 10 body lengths around (external) or just around (internal)
    Flow flow = Flow::automatic;         // automatic: seeds if there are any, else external
    std::vector<Seed> seeds;
    std::vector<Seed> keepOut;           // places that the flow must not reach
};

struct FitOptions {
    double clearance = 0.1;              // cell edges between a kept lattice vertex and the geometry
    int sweeps = 4;                      // of smoothing and projection
    bool features = true;                // snap to sharp edges and corners
    double seconds = 0;                  // s, after which the fit begins no further sweep; 0: as many as it takes
    bool passages = true;                // keep cut cells whose centre has room too: nearer to walls, into passages
};

enum class LayerUnit : std::uint8_t { metre, cell };

// Layers on the walls of a part. What is 0 is as for all walls; of these the growth stays before the thickness, and the
// first height before both, where they would be more than two.
struct PartLayers {
    std::string part;                    // name or regular expression (whole name); the last one that fits counts
    int count = 1;                       // 0: none, one cell between front and wall stays
    double first = 0, thickness = 0;     // in LayerOptions::unit
    double growth = 0;
};

// Of first height, thickness and growth two give the third. With neither height the layers fill the room between the
// Cartesian cells and the wall.
struct LayerOptions {
    int count = 1;                       // prism layers on every wall face; 0: none, one cell stays
    double first = 0;                    // height of the one at the wall, in unit; 0: not given
    double growth = 0;                   // ratio of heights, outwards; 0: from the two heights, else 1.2
    double thickness = 0;                // of all layers together, in unit; 0: not given
    LayerUnit unit = LayerUnit::metre;   // cell: shares of the size of the Cartesian cells at the place
    double yPlus = 0;                    // gives first, with the three below; 0: not given
    double velocity = 0;                 // m/s, of the flow
    double viscosity = 0;                // m^2/s, kinematic
    double length = 0;                   // m, along the flow, of the body
    std::vector<PartLayers> parts{};
};

struct OutputOptions {
    std::string folder = "i2b-case";
    std::vector<std::string> formats{"openfoam", "vtu", "ply", "vdb", "report"};
    bool ascii = false;                  // polyMesh as text instead of binary
    bool wants(std::string_view format) const { return std::find(formats.begin(), formats.end(), format) != formats.end(); }
};

struct Options {
    GeometryOptions geometry;
    SizeOptions size;
    DomainOptions domain;
    FitOptions fit;
    LayerOptions layers;
    DictionaryLimits quality;            // what check and the report count faces against; the mesher heeds its own
    OutputOptions output;
    int threads = 0;                     // 0: all the machine has
};

} // namespace i2b
