// How well the wall follows the test shapes (tests/pipeline/shapes.h): every shape, side, size and random pose is meshed and
// measured. One line a shape and side: the worst and the mean over all its runs. For those who work on the fit.
//
//     shapes_benchmark [--poses N] [--sizes H,H,...] [--runs FILE.csv] [--lost FILE.csv] [--ply FOLDER] [SHAPE[:outside|:inside] ...]
//
// --poses 10 by default; --runs writes a line for every run, --lost one for every stretch of a sharp edge that is not captured; --ply writes every wall, SHAPE-SIDE-H-POSE.ply, and what it is of, SHAPE-H-POSE.stl.
#include "i2b/geometry/write_stl.h"
#include "i2b/write/ply_write.h"
#include "pipeline/shape_run.h"
#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <iostream>

namespace {

using namespace i2b;
using namespace i2b::test;

struct Arguments {
    unsigned poses = 10;
    std::vector<double> sizes{shapeSizes.begin(), shapeSizes.end()};
    std::string runs, lost, ply;
    std::vector<std::string> shapes; // empty: all
};

std::vector<double> numbersIn(const std::string& text) {
    std::vector<double> numbers;
    for (std::size_t at = 0; at < text.size();) {
        std::size_t end = std::min(text.find(',', at), text.size());
        numbers.push_back(std::stod(text.substr(at, end - at)));
        at = end + 1;
    }
    return numbers;
}

Arguments read(int argc, char** argv) {
    Arguments a;
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        const auto value = [&] { return ++i < argc ? std::string(argv[i]) : throw std::runtime_error(word + " needs a value"); };
        if (word == "--poses")
            a.poses = static_cast<unsigned>(std::stoul(value()));
        else if (word == "--sizes")
            a.sizes = numbersIn(value());
        else if (word == "--runs")
            a.runs = value();
        else if (word == "--lost")
            a.lost = value();
        else if (word == "--ply")
            a.ply = value();
        else if (word.starts_with("-"))
            throw std::runtime_error("no option " + word);
        else
            a.shapes.push_back(word);
    }
    return a;
}

// Of a figure over the runs; worst is the largest or the smallest, as add() is told.
struct Spread {
    double worst = 0, sum = 0;
    std::int64_t count = 0;
    void add(double v, bool largeIsBad) {
        worst = count == 0 ? v : largeIsBad ? std::max(worst, v) : std::min(worst, v);
        sum += v, ++count;
    }
    double mean() const { return count > 0 ? sum / static_cast<double>(count) : 0; }
};

struct Figures {
    int runs = 0, invalid = 0, failing = 0; // failing: a check of plain checkMesh
    Spread nonOrthogonality, skewness, nodes, faces, capture, sampled, tilted, extended;

    void add(const ShapeRun& run) {
        ++runs;
        if (!run.fault.empty()) ++invalid;
        if (run.quality.cells == 0) return;
        const QualityReport& q = run.quality;
        failing += !plainFailures(q).empty();
        nonOrthogonality.add(q.maxNonOrthogonality, true);
        skewness.add(q.maxSkewness, true);
        nodes.add(run.fit.wallNodesOnGeometryFraction, false);
        faces.add(run.fit.meanDistanceInH, true);
        if (run.fit.featureSamples > 0) capture.add(run.fit.featureCaptureFraction, false);
        sampled.add(run.sampled, false);
        tilted.add(run.fit.tiltedFaceFraction, true);
        extended.add(static_cast<double>(q.smallDeterminantCells + q.lowWeightFaces + q.lowVolumeRatioFaces), true);
    }
};

std::string percent(const Spread& s) {
    return s.count > 0 ? fmt::format("{:7.2f} {:7.2f}", 100 * s.worst, 100 * s.mean()) : fmt::format("{:>7} {:>7}", "-", "-");
}

void print(const std::string& name, const Figures& f) {
    std::cout << fmt::format("{:<37} {:>4} {:>3} {:>3}  {:5.1f} {:6.2f} {:4.0f}   {}   {:5.0f}   {}   {}   {:6.3f}\n", name, f.runs, f.invalid,
                             f.failing, f.nonOrthogonality.worst, f.skewness.worst, f.extended.worst,
                             percent(f.capture), 100 * f.sampled.worst, percent(f.nodes), percent(f.tilted), f.faces.worst)
              << std::flush;
}

const char* nameOf(Side side) { return side == Side::inside ? "inside" : "outside"; }

void record(std::ofstream& out, const std::string& name, double h, unsigned pose, const ShapeRun& run) {
    if (!out.is_open()) return;
    const auto& lost = run.fit.lostEdges.lengthOf;
    out << fmt::format("{},{},{},{},{:.2f},{:.3f},{:.5f},{},{:.3f},{:.5f},{:.5f},{:.4f},{:.4f},{:.2f},{:.2f},{:.2f},{:.2f},{},{}\n", name, h, pose,
                       run.quality.cells,
                       run.quality.maxNonOrthogonality, run.quality.maxSkewness, run.fit.featureCaptureFraction,
                       run.fit.featureSamples, run.sampled, run.fit.wallNodesOnGeometryFraction, run.fit.tiltedFaceFraction,
                       run.fit.meanDistanceInH, run.fit.maxDistanceInH, lost[0] / h, lost[1] / h, lost[2] / h, lost[3] / h, plainFailures(run.quality), run.fault)
        << std::flush;
}

void recordLost(std::ofstream& out, const std::string& name, double h, unsigned pose, const ShapeRun& run) {
    if (!out.is_open()) return;
    for (const LostEdge& e : run.fit.lostEdges.first)
        out << fmt::format("{},{},{},{},{:.2f},{:.5f},{:.5f},{:.5f}\n", name, h, pose, nameOf(e.cause), e.length / h, e.at.x, e.at.y, e.at.z);
    out << std::flush;
}

Figures measure(const Shape& shape, Side side, const Arguments& a, std::ofstream& runs, std::ofstream& lost) {
    Figures figures;
    for (const double h : a.sizes)
        for (unsigned pose = 0; pose < a.poses; ++pose) {
            const ShapeRun run = meshShape(shape, side, h, pose);
            figures.add(run);
            const std::string name = fmt::format("{}:{}", shape.name, nameOf(side));
            record(runs, name, h, pose, run);
            recordLost(lost, name, h, pose, run);
            if (a.ply.empty() || run.mesh.cells == 0) continue;
            writePly(run.mesh, fmt::format("{}/{}-{}-{}-{}.ply", a.ply, shape.name, nameOf(side), h, pose), Context());
            writeStl(posed(shape, h, pose).soup, fmt::format("{}/{}-{}-{}.stl", a.ply, shape.name, h, pose), StlFormat::binary);
        }
    return figures;
}

bool wanted(const Arguments& a, const Shape& shape, Side side) {
    if (shape.sides != Side::both && shape.sides != side) return false;
    const auto names = [&](const std::string& s) { return s == shape.name || s == fmt::format("{}:{}", shape.name, nameOf(side)); };
    return a.shapes.empty() || std::ranges::any_of(a.shapes, names);
}

} // namespace

int main(int argc, char** argv) try {
    const Arguments a = read(argc, argv);
    if (!a.ply.empty()) std::filesystem::create_directories(a.ply);
    std::ofstream runs, lost;
    if (!a.lost.empty()) {
        lost.open(a.lost);
        lost << "shape,h,pose,cause,length_h,x,y,z\n";
    }
    if (!a.runs.empty()) {
        runs.open(a.runs);
        runs << "shape,h,pose,cells,non_orthogonality,skewness,capture,samples,sampled,nodes_on_geometry,tilted,"
                "faces_off_h,farthest_h,shallow_h,crossed_h,bridged_h,left_out_h,plain_failures,fault\n";
    }
    std::cout << "runs; how many invalid, and failing plain checkMesh; worst non-orthogonality, skewness, number of small\n"
                 "determinants + low weights + low volume ratios; then worst and mean: resolvable sharp edges captured (and\n"
                 "how much of all sharp lines was judged at all: the wall within h / 2 of it), wall nodes within 0.01 h,\n"
                 "faces tilted (%); wall face centres off the geometry, worst run's mean (h)\n\n"
              << fmt::format("{:<37} {:>4} {:>3} {:>3}  {:>5} {:>6} {:>4}   {:>15}   {:>5}   {:>15}   {:>15}   {:>6}\n", "shape",
                             "runs", "inv", "bad", "n-o", "skew", "ext", "captured %", "of %", "nodes on %", "tilted %", "off h");
    for (const Shape& shape : shapes())
        for (const Side side : {Side::outside, Side::inside})
            if (wanted(a, shape, side)) print(fmt::format("{}:{}", shape.name, nameOf(side)), measure(shape, side, a, runs, lost));
    return 0;
} catch (const std::exception& e) {
    std::cerr << "shapes_benchmark: " << e.what() << '\n';
    return 2;
}
