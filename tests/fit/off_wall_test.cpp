// Proves: a node that is off the geometry for a known reason is given that cause; of whole runs the counts are those of the
// measure of the fit, the list of places is sorted and complete, and nothing depends on the number of threads; a fit cut
// short gives a valid mesh and says so.
#include "i2b/fit/off_wall.h"
#include "i2b/geometry/write_stl.h"
#include "i2b/program/generate.h"
#include "i2b/samples/builder.h"
#include <filesystem>
#include <gtest/gtest.h>
#include <numeric>
#include <tbb/global_control.h>
#include <unistd.h>

namespace i2b::test {
namespace {

constexpr double h = 0.05;           // m, cells at the wall, which begin at multiples of it
constexpr double top = 0.385, side = 0.485; // m: 0.3 h short of the cells' faces, so that the front stands clear

samples::Loop2 rectangle(double u0, double v0, double u1, double v1) { return {{u0, v0}, {u1, v0}, {u1, v1}, {u0, v1}}; }

Surface surfaceOf(const samples::Mesh& mesh, const char* name) {
    Surface s;
    s.points = mesh.points;
    for (const auto& t : mesh.triangles) s.triangles.push_back({t[0], t[1], t[2]});
    s.partOf.assign(s.triangles.size(), 0);
    s.parts = {Part{name, "", s.triangles.size()}};
    return s;
}

// A block with a slot along x in its top, `width` cells wide and `depth` deep.
Surface slotted(double width, double depth, const samples::Frame& frame = samples::lengthwise(-side)) {
    const double a = width * h / 2, bottom = top - depth * h;
    return surfaceOf(samples::extrude(frame, {{-side, -top}, {side, -top}, {side, top}, {a, top}, {a, bottom}, {-a, bottom}, {-a, top}, {-side, top}}, {},
                                      {0, 2 * side}),
                     "block");
}

// The same askew, so that the wall is off it in places.
Surface askew() { return slotted(1.2, 6, samples::along({-0.45, -0.1, -0.15}, {1, 0.3, 0.2})); }

// A hollow shell of one sheet with a square hole, `width` cells wide, in its top.
Surface pierced(double width) {
    const double a = width * h / 2;
    samples::Mesh mesh = samples::extrude(samples::upright({0, 0, -side}), rectangle(-side, -side, side, side), {}, {0, 2 * side}, {true, false});
    samples::Mesh lid; // four strips around the hole
    const double at[4] = {-side, -a, a, side};
    for (int j = 0; j < 4; ++j)
        for (int i = 0; i < 4; ++i) lid.points.push_back({at[i], at[j], side});
    for (std::uint32_t j = 0; j < 3; ++j)
        for (std::uint32_t i = 0; i < 3; ++i) {
            if (i == 1 && j == 1) continue;
            const std::uint32_t k = 4 * j + i;
            lid.triangles.push_back({k, k + 1, k + 5});
            lid.triangles.push_back({k, k + 5, k + 4});
        }
    samples::append(mesh, lid);
    return surfaceOf(mesh, "shell");
}

std::string temporaryFile() {
    return (std::filesystem::temp_directory_path() / ("i2b_off_wall_" + std::to_string(getpid()) + ".stl")).string();
}

Options optionsFor(const std::string& file) {
    Options options;
    options.geometry.files = {file};
    options.size.surface = h;
    options.size.max = 4 * h;
    options.domain.box = Box{{-1.2, -1.2, -1.2}, {1.2, 1.2, 1.2}};
    options.domain.flow = Flow::external;
    return options;
}

struct Meshed {
    MeshResult result;
    const OffGeometry& off() const { return *result.report.offGeometry; }
    const FitReport& fit() const { return *result.report.fit; }
};

Meshed meshed(const Surface& soup, double seconds = 0) {
    const std::string file = temporaryFile();
    writeStl(soup, file, StlFormat::ascii);
    Options options = optionsFor(file);
    options.fit.seconds = seconds;
    Context context;
    Meshed run{generate(options, context)};
    std::filesystem::remove(file);
    return run;
}

std::int64_t count(const Meshed& run, OffCause cause) { return run.off().counts[static_cast<std::size_t>(cause)]; }

// What must hold of any run.
void expectConsistent(const Meshed& run) {
    const OffGeometry& off = run.off();
    const WallNodes& nodes = run.result.wallNodes;
    ASSERT_EQ(static_cast<std::int64_t>(nodes.points.size()), run.fit().wallNodes);
    ASSERT_EQ(run.result.offCauses.size(), nodes.points.size());
    ASSERT_EQ(nodes.distanceInH.size(), nodes.points.size());
    std::int64_t far = 0;
    for (std::size_t i = 0; i < nodes.points.size(); ++i) {
        const double distance = run.result.cartesian->index->closest(run.result.mesh.points[static_cast<std::size_t>(nodes.points[i])]).distance;
        EXPECT_EQ(nodes.distanceInH[i] == 0, distance == 0);
        const bool isOff = run.result.offCauses[i] != OffCause::none && run.result.offCauses[i] != OffCause::tilted;
        EXPECT_EQ(isOff, nodes.distanceInH[i] > 0.01);
        far += isOff;
    }
    const auto total = static_cast<double>(run.fit().wallNodes);
    EXPECT_EQ(off.nodes, far);
    EXPECT_NEAR(off.fraction, 1 - run.fit().wallNodesOnGeometryFraction, 1e-12);
    EXPECT_NEAR(static_cast<double>(off.nodes), total * off.fraction, 1e-6);
    EXPECT_EQ(std::accumulate(off.counts.begin(), off.counts.end(), std::int64_t(0)), off.nodes + off.tilted);
    std::int64_t inPlaces = 0;
    double farthest = 0;
    for (std::size_t i = 0; i < off.places.first.size(); ++i) {
        const OffPlace& p = off.places.first[i];
        inPlaces += p.nodes;
        farthest = std::max(farthest, p.farthestInH);
        EXPECT_TRUE(p.box.contains(p.centre) && p.box.contains(p.farthest));
        EXPECT_FALSE(p.part.empty());
        EXPECT_TRUE(p.cause != OffCause::none && p.cause != OffCause::tilted);
        if (i == 0) continue;
        const OffPlace& before = off.places.first[i - 1];
        EXPECT_TRUE(before.nodes > p.nodes || (before.nodes == p.nodes && before.farthestInH >= p.farthestInH));
    }
    EXPECT_EQ(off.places.first.size(), static_cast<std::size_t>(std::min<std::int64_t>(100, off.places.total)));
    if (off.places.total > 100) return; // not complete
    EXPECT_EQ(inPlaces, off.nodes);
    if (off.nodes > 0) {
        EXPECT_EQ(farthest, run.fit().maxDistanceInH);
    }
}

// A band whose wall nodes are on their targets, but for those that a test puts elsewhere: what is asked does not hang on how
// well the fit does.
struct Placed {
    explicit Placed(Surface soup) {
        const std::string file = temporaryFile();
        writeStl(soup, file, StlFormat::ascii);
        const Options options = optionsFor(file);
        Context context;
        grid = generateGrid(options, context, Road::mesh);
        std::filesystem::remove(file);
        lattice = std::make_unique<LatticeMesh>(grid->grid, grid->kept);
        front = buildFront(*lattice, startThickness);
        band = buildBand(*lattice, front, 2);
        features = std::make_unique<FeatureIndex>(buildFeatureGraph(grid->surface, FeatureOptions{}));
        snaps.resize(band.walls);
        x = band.start;
        for (std::size_t n = 0; n < band.walls; ++n) x[n] = wallTarget(*grid->index, band, n, frontOf(n), x[n]).point;
    }
    const Vec3& frontOf(std::size_t n) const { return band.start[static_cast<std::size_t>(band.frontNode[n])]; }
    // The wall node whose front node is nearest to p.
    std::size_t nodeAt(const Vec3& p) const {
        std::size_t best = 0;
        for (std::size_t n = 1; n < band.walls; ++n)
            if (norm2(frontOf(n) - p) < norm2(frontOf(best) - p)) best = n;
        return best;
    }
    OffCause causeOf(std::size_t n) const {
        EnergyOptions strict; // so that any move for the worse is refused
        strict.floor = strict.featureFloor = 2;
        return findOffCauses(band, *grid->index, *features, snaps, x, strict)[n];
    }
    std::unique_ptr<GridResult> grid;
    std::unique_ptr<LatticeMesh> lattice;
    Front front;
    Band band;
    std::unique_ptr<FeatureIndex> features;
    std::vector<Snap> snaps;
    Positions x;
};

// Nodes in the mouth of a slot, between its lips, are over a gap; so are those over a groove's bottom.
TEST(OffCauses, Gap) {
    for (const double depth : {6.0, 0.6}) {
        Placed p(slotted(0.8, depth));
        const std::size_t n = p.nodeAt({0, 0, 0.4});
        EXPECT_EQ(p.causeOf(n), OffCause::none); // on a lip
        for (std::size_t m = 0; m < p.band.walls; ++m) {
            const Vec3 f = p.frontOf(m);
            if (std::abs(f.y) < 0.1 * h && std::abs(f.z - 0.4) < 0.1 * h) p.x[m] = {f.x, 0, top};
        }
        EXPECT_EQ(p.causeOf(n), OffCause::gap) << "depth " << depth;
    }
}

// A node in a hole of a sheet with nothing behind bridges an opening; so does one away from all geometry.
TEST(OffCauses, Bridged) {
    Placed p(pierced(0.9));
    const std::size_t n = p.nodeAt({0, 0, 0.5});
    p.x[n] = {0, 0, side};
    EXPECT_EQ(p.causeOf(n), OffCause::bridged);
    p.x[n] = {0, 0, side + 2.5 * h};
    EXPECT_EQ(p.causeOf(n), OffCause::bridged);
    Placed slot(slotted(0.8, 6)); // has no opening
    const std::size_t m = slot.nodeAt({0, 0, 0.4});
    slot.x[m] = {0, 0, top};
    EXPECT_NE(slot.causeOf(m), OffCause::bridged);
}

// On one side of a block: behind the sheet, short of it with a free way, in a side of the domain that the sheet does not reach.
TEST(OffCauses, FlatSide) {
    Placed p(pierced(0.9));
    const std::size_t n = p.nodeAt({0.25, 0.25, 0.5});
    const Vec3 on = p.x[n];
    EXPECT_NEAR(on.z, side, 1e-12);
    p.x[n] = on - Vec3{0, 0, 0.3 * h};
    EXPECT_EQ(p.causeOf(n), OffCause::sheetBetween);
    p.x[n] = on + Vec3{0, 0, 0.1 * h};
    EXPECT_EQ(p.causeOf(n), OffCause::unfinished);
    p.band.outside[n] = 1 << 4;
    EXPECT_EQ(p.causeOf(n), OffCause::boxSide);
    p.band.outside[n] = 0;
    p.x[n] = on + Vec3{0, 0, 0.004 * h};
    EXPECT_EQ(p.causeOf(n), OffCause::none);
}

// Held to an edge that it has not reached; held to a place off the geometry, and there; near an edge and not held to it.
TEST(OffCauses, Features) {
    Placed p(surfaceOf(samples::box({-side, -side, -side}, {side, side, side}), "block"));
    const std::size_t n = p.nodeAt({0.5, 0, 0.5});
    p.x[n] = {side + 0.1 * h, 0, side + 0.1 * h};
    p.snaps[n] = {SnapKind::corner, {side, 0.6 * h, side}, {}}; // sideways: worse than where it is
    EXPECT_EQ(p.causeOf(n), OffCause::feature);
    p.snaps[n] = {SnapKind::corner, p.x[n], {}};
    EXPECT_EQ(p.causeOf(n), OffCause::featureOff);
    const std::size_t m = p.nodeAt({0.45, 0, 0.5}); // its target is sideways of a place over its neighbour
    p.x[m] = {side + 0.3 * h, 0, side - 0.1 * h};
    const OffCause cause = p.causeOf(m);
    EXPECT_TRUE(cause == OffCause::besideEdge || cause == OffCause::sheetBetween) << nameOf(cause);
}

// A node in a corner of the flow, low over one wall and near the other, faces no gap.
TEST(OffCauses, CornerIsNoGap) {
    Surface soup = surfaceOf(samples::box({-side, -side, -side}, {side, side, 0.085}), "floor");
    const samples::Mesh wall = samples::box({-side, -side, 0.05}, {-0.015, side, side});
    const auto first = static_cast<std::uint32_t>(soup.points.size());
    soup.points.insert(soup.points.end(), wall.points.begin(), wall.points.end());
    for (const auto& t : wall.triangles) soup.triangles.push_back({first + t[0], first + t[1], first + t[2]}), soup.partOf.push_back(0);
    soup.parts[0].triangles = soup.triangles.size();
    Placed p(soup);
    const std::size_t n = p.nodeAt({0, 0, 0.1});
    p.x[n] = {-0.015 + 0.1 * h, 0.3 * h, 0.085 + 0.05 * h};
    const OffCause cause = p.causeOf(n);
    EXPECT_TRUE(cause == OffCause::besideEdge || cause == OffCause::unfinished) << nameOf(cause);
}

// A plain block has no gaps, no openings and no sides of the domain.
TEST(OffWall, BlockHasNoGaps) {
    const Meshed run = meshed(surfaceOf(samples::box({-0.512, -0.437, -0.391}, {0.473, 0.511, 0.407}), "block"));
    expectConsistent(run);
    EXPECT_EQ(count(run, OffCause::gap) + count(run, OffCause::bridged) + count(run, OffCause::boxSide), 0);
    EXPECT_LT(run.off().fraction, 0.01);
}

TEST(OffWall, SameOnAnyNumberOfThreads) {
    const Surface soup = askew();
    const Meshed one = meshed(soup);
    expectConsistent(one);
    EXPECT_GT(one.off().nodes, 0);
    for (const std::size_t threads : {1u, 3u}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        const Meshed other = meshed(soup);
        EXPECT_EQ(one.result.offCauses, other.result.offCauses);
        EXPECT_EQ(one.result.wallNodes.distanceInH, other.result.wallNodes.distanceInH);
        ASSERT_EQ(one.off().places.first.size(), other.off().places.first.size());
        for (std::size_t i = 0; i < one.off().places.first.size(); ++i) {
            const OffPlace &a = one.off().places.first[i], &b = other.off().places.first[i];
            EXPECT_TRUE(a.nodes == b.nodes && a.centre == b.centre && a.box == b.box && a.cause == b.cause && a.farthest == b.farthest);
        }
    }
}

// A budget that is over at once leaves a valid mesh, further off than without one; a generous one changes nothing.
TEST(FitSeconds, CutShortIsValidAndSaysSo) {
    const Surface soup = askew();
    const Meshed whole = meshed(soup), none = meshed(soup, 1e-9), ample = meshed(soup, 1e5);
    EXPECT_FALSE(whole.result.report.fitCutShort);
    EXPECT_FALSE(ample.result.report.fitCutShort);
    EXPECT_EQ(whole.result.mesh.checksum(), ample.result.mesh.checksum());
    EXPECT_TRUE(none.result.report.fitCutShort);
    expectConsistent(none);
    EXPECT_EQ(none.result.mesh.validate(), "");
    EXPECT_EQ(none.result.report.quality->negativeVolumeCells, 0);
    EXPECT_EQ(none.result.report.quality->wrongOrientedFaces, 0);
    EXPECT_LT(none.fit().featureCaptureFraction, whole.fit().featureCaptureFraction);
}

} // namespace
} // namespace i2b::test
