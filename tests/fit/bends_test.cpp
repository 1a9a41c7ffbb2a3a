// Proves: quads are cut where that brings the wall nearer to a bend, nowhere on flat sides, without moving a node and with valid
// prisms; faces that must stay whole do; the same on any number of threads.
#include "i2b/fit/bends.h"
#include "i2b/layers/lay_on.h"
#include "i2b/quality/quality_report.h"
#include "pipeline/stages_run.h"
#include <gtest/gtest.h>
#include <tbb/global_control.h>

namespace i2b::test {
namespace {

// A front on a box whose edges the fit was not to look for: its quads cut across them.
struct Blunt : ToFront {
    Blunt() : ToFront(turnedBox(), stagesOptions()) {
        FitOptions options;
        options.features = false;
        fitFront(front, lattice, *painted.index, graph, options, {});
    }
    std::vector<Vec3> walls() const {
        std::vector<Vec3> places;
        for (std::size_t v = 0; v < front.front.size(); ++v) places.push_back(wallPoint(front, v));
        return places;
    }
    double offOf(FrontMesh::FaceHandle f) const { // m, of its middle
        Vec3 middle;
        double n = 0;
        for (auto v : front.mesh.fv_range(f)) middle += wallPoint(front, static_cast<std::size_t>(v.idx())), ++n;
        return painted.index->closest(middle / n).distance;
    }
    double meanOff() const { // by area
        double sum = 0, area = 0;
        for (auto f : front.mesh.faces()) {
            Vec3 twice, first, last;
            bool any = false;
            for (auto v : front.mesh.fv_range(f)) {
                const Vec3 p = wallPoint(front, static_cast<std::size_t>(v.idx()));
                if (!any) first = p, any = true;
                else twice += cross(last - first, p - first);
                last = p;
            }
            sum += offOf(f) * norm(twice), area += norm(twice);
        }
        return sum / area;
    }
};

TEST(Bends, CutsBringTheWallNearer) {
    Blunt b;
    const std::vector<Vec3> before = b.walls();
    const double off = b.meanOff();
    const std::size_t faces = b.front.ownerCell.size();
    std::vector<std::size_t> flatOf(b.lattice.cellCount(), 0), now = flatOf; // faces on one side, per owner
    const auto countFlat = [&](std::vector<std::size_t>& count) {
        for (auto f : b.front.mesh.faces()) count[static_cast<std::size_t>(b.front.ownerCell[static_cast<std::size_t>(f.idx())])] += b.offOf(f) < 0.01 * stagesSize;
    };
    countFlat(flatOf);
    const std::size_t cut = cutAcrossBends(b.front, *b.painted.index);
    EXPECT_GT(cut, 15u);
    EXPECT_EQ(b.front.ownerCell.size(), faces + cut);
    EXPECT_EQ(b.front.validate(), "");
    EXPECT_EQ(b.walls(), before);
    EXPECT_LT(b.meanOff(), off);
    countFlat(now);
    std::size_t flats = 0;
    for (std::size_t c = 0; c < now.size(); ++c) {
        EXPECT_GE(now[c], flatOf[c]) << "owner " << c; // a quad on a side stays, pieces may come to lie on one
        flats += flatOf[c];
    }
    EXPECT_GT(flats, 500u);
    EXPECT_EQ(cutAcrossBends(b.front, *b.painted.index), 0u); // triangles are not cut
    assignParts(b.front, *b.painted.index);
    const WallPlans plans = plansOf({}, b.painted.soup.parts);
    const LaidLayers laid = layOn(b.front, plans, *b.painted.index);
    const QualityReport q = measureQuality(assemble({b.lattice, b.kept, b.front, laid.stack, b.painted.soup.parts}));
    EXPECT_EQ(q.negativeVolumeCells, 0);
    EXPECT_EQ(q.openCells, 0);
}

TEST(Bends, WholeFacesStay) {
    Blunt b;
    b.front.whole = b.front.ownerCell;
    EXPECT_EQ(cutAcrossBends(b.front, *b.painted.index), 0u);
}

// What makeWalls() falls back on: the whole fit cuts nothing then, where it otherwise does.
TEST(Bends, FitLeavesWholeFacesWhole) {
    ToFront free(turnedBox(), stagesOptions()), held(turnedBox(), stagesOptions());
    const std::size_t faces = held.front.ownerCell.size();
    held.front.whole = held.front.ownerCell;
    const FitSummary cut = fitFront(free.front, free.lattice, *free.painted.index, free.graph, FitOptions{}, {});
    const FitSummary whole = fitFront(held.front, held.lattice, *held.painted.index, held.graph, FitOptions{}, {});
    EXPECT_GT(cut.split + cut.inserted, 0u);
    EXPECT_EQ(whole.split + whole.inserted, 0u);
    EXPECT_EQ(held.front.ownerCell.size(), faces);
    EXPECT_EQ(held.front.validate(), "");
}

TEST(Bends, SameOnAnyNumberOfThreads) {
    std::uint64_t sum = 0;
    for (const std::size_t threads : {1u, 3u}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        Blunt b;
        cutAcrossBends(b.front, *b.painted.index);
        if (threads == 1) sum = b.front.checksum();
        EXPECT_EQ(b.front.checksum(), sum);
    }
}

} // namespace
} // namespace i2b::test
