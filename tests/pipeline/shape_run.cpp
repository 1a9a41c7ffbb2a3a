#include "pipeline/shape_run.h"
#include "i2b/core/error.h"
#include "i2b/geometry/write_stl.h"
#include "i2b/program/generate.h"
#include "pipeline/pose.h"
#include <algorithm>
#include <filesystem>
#include <unistd.h>
#include <utility>

namespace i2b::test {
namespace {

Options optionsOf(const ShapeGeometry& g, Side side, double h) {
    Options o;
    o.size.surface = h;
    o.size.max = 4 * h;
    // A whole number of the largest cells, so that those at the wall are h exactly.
    const double half = std::ceil((shapeRadius + 4 * h) / (4 * h)) * 4 * h;
    o.domain.box = Box{{-half, -half, -half}, {half, half, half}};
    o.domain.flow = side == Side::inside ? Flow::internal : Flow::external;
    if (!g.seeds.empty()) o.domain.flow = Flow::automatic, o.domain.seeds = g.seeds;
    return o;
}

std::filesystem::path temporaryFile() {
    static int count = 0;
    return std::filesystem::temp_directory_path() /
           ("i2b_shape_" + std::to_string(getpid()) + "_" + std::to_string(count++) + ".stl");
}

// The soup's own edges and the lines that it does not know of, these as sharp as can be.
FeatureGraph sharpLines(const Surface& soup, const ShapeGeometry& g) {
    FeatureGraph features = buildFeatureGraph(soup, {});
    for (const auto& [from, to] : g.lines) {
        const auto n = static_cast<std::uint32_t>(features.points.size());
        features.points.insert(features.points.end(), {from, to});
        features.edges.push_back({n, n + 1, static_cast<std::uint8_t>(EdgeKind::sharp), 180});
    }
    return features;
}

// Of cracks the line counts that the wall follows best.
FitReport fitOf(const PolyMesh& mesh, const SurfaceIndex& index, ShapeGeometry g) {
    const Rows cellFaces = buildCellFaces(mesh);
    FitReport best = measureFit(mesh, cellFaces, index, sharpLines(index.surface(), g));
    for (std::size_t crack = 0; crack < g.rims.size(); ++crack)
        for (const auto& rim : g.rims[crack]) {
            const auto before = std::exchange(g.lines[crack], rim);
            const FitReport fit = measureFit(mesh, cellFaces, index, sharpLines(index.surface(), g));
            if (fit.featureCaptureFraction > best.featureCaptureFraction) best = fit;
            else g.lines[crack] = before;
        }
    return best;
}

double sharpLength(const FeatureGraph& features) {
    double length = 0;
    for (const FeatureEdge& e : features.edges)
        if (e.angle >= 40) length += norm(features.points[e.b] - features.points[e.a]);
    return length;
}

std::string faultOf(const PolyMesh& mesh, const QualityReport& q) {
    if (std::string fault = mesh.validate(); !fault.empty()) return fault;
    if (q.negativeVolumeCells > 0) return std::to_string(q.negativeVolumeCells) + " negative volumes";
    if (q.wrongOrientedFaces > 0) return std::to_string(q.wrongOrientedFaces) + " wrong oriented faces";
    if (q.openCells > 0) return std::to_string(q.openCells) + " open cells";
    return "";
}

} // namespace

ShapeGeometry posed(const Shape& shape, double h, unsigned seed) {
    const Pose pose(shape.name, h, seed);
    ShapeGeometry g = shape.make(h);
    for (Vec3& p : g.soup.points) p = pose(p);
    for (auto& line : g.lines) line = {pose(line[0]), pose(line[1])};
    for (auto& crack : g.rims)
        for (auto& line : crack) line = {pose(line[0]), pose(line[1])};
    for (Seed& s : g.seeds) s.place = pose(s.place);
    return g;
}

ShapeRun meshShape(const Shape& shape, Side side, double h, unsigned seed) {
    const ShapeGeometry g = posed(shape, h, seed);
    Options options = optionsOf(g, side, h);
    const std::filesystem::path file = temporaryFile();
    options.geometry.files = {file.string()};
    ShapeRun run;
    try {
        writeStl(g.soup, file.string(), StlFormat::ascii);
        Context context;
        MeshResult result = generate(options, context);
        run.mesh = std::move(result.mesh);
        run.quality = result.report.quality.value();
        run.fit = fitOf(run.mesh, *result.cartesian->index, g);
        if (const double length = sharpLength(sharpLines(g.soup, g)); length > 0)
            run.sampled = static_cast<double>(run.fit.featureSamples) * h / 4 / length;
        run.fault = faultOf(run.mesh, run.quality);
    } catch (const Error& e) {
        run.fault = e.problem() + ": " + e.remedy();
    }
    std::filesystem::remove(file);
    return run;
}

std::string plainFailures(const QualityReport& quality) {
    static constexpr std::string_view extended[] = {
        "zipUpCells", "edgeFaces",    "oneInternalFaceCells", "twoInternalFacesCells", "lowQualityTetFaces",
        "shortEdges", "nearPoints",   "concaveFaces",         "warpedFaces",           "underdeterminedCells",
        "concaveCells", "lowWeightFaces", "lowVolRatioFaces"};
    std::string names;
    for (const QualityCheck& c : quality.checks)
        if (c.fails && std::ranges::find(extended, c.name) == std::end(extended))
            names += c.name + " " + std::to_string(c.count) + " ";
    return names;
}

} // namespace i2b::test
