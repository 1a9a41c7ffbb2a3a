// Proves: layer heights fall towards the wall by the growth ratio and fill the way from front to wall, or are as asked
// where there is room; counts differ by one at most between neighbours and are the same on any number of threads; the
// report says what was reached and why not more.
#include "carve/kept_checks.h"
#include "i2b/layers/layer_report.h"
#include "i2b/layers/layer_stack.h"
#include <gmock/gmock.h>
#include <numeric>
#include <tbb/global_control.h>

namespace i2b::test {
namespace {

// Parts by octants around the middle, so that their borders run across faces of all directions.
struct Sample {
    Sample()
        : carved(3, {5, 6, 4}, 2, 1, 0.1), lattice(carved.grid, carved.kept),
          front(buildFront(lattice, 0.07)) {
        Box box;
        for (const Vec3& p : front.front) box.add(p);
        for (std::size_t f = 0; f < faces(); ++f) {
            const auto v = static_cast<std::size_t>(front.mesh.fv_begin(FrontMesh::FaceHandle(static_cast<int>(f)))->idx());
            const Vec3 d = front.front[v] - box.centre();
            front.part[f] = (d.x > 0) + 2 * (d.y > 0);
        }
    }
    std::size_t faces() const { return front.ownerCell.size(); }
    // Heights of vertex v's layers, front to wall.
    std::vector<double> heights(const LayerStack& s, std::size_t v) const {
        std::vector<double> z(static_cast<std::size_t>(s.pointsOf(v)));
        const double room = roomAt(front, v);
        s.heights(v, room, z.data());
        std::vector<double> h;
        for (std::size_t k = 0; k < z.size(); ++k) h.push_back((k == 0 ? room : z[k - 1]) - z[k]);
        return h;
    }
    // Its n layers at the wall, from there.
    std::vector<double> fromWall(const LayerStack& s, std::size_t v) const {
        std::vector<double> h = heights(s, v);
        std::reverse(h.begin(), h.end());
        return h;
    }
    double leastRoom() const {
        double least = roomAt(front, 0);
        for (std::size_t v = 0; v < front.front.size(); ++v) least = std::min(least, roomAt(front, v));
        return least;
    }
    CarvedAtRandom carved;
    LatticeMesh lattice;
    Front front;
    std::vector<Part> parts{{"a", "", 1}, {"b", "", 1}, {"c", "", 1}, {"d", "", 1}};
};

LayerOptions options(int count, double growth, double first = 0) {
    LayerOptions o;
    o.count = count, o.growth = growth, o.first = first;
    return o;
}

LayerReport reportOf(const Sample& s, const LayerStack& stack, int requested) {
    return summarize(measureLayers(s.front, stack), s.front, s.parts, requested);
}

// Two layers and a cell as high; the rule for all counts only while some part has it.
TEST(Layers, WantRoomForTheHighestRuleThatAPartHas) {
    LayerOptions all = options(2, 1, 1e-3);
    all.parts.push_back({"a", 2, 0, 0, 0});
    all.parts.back().first = 5e-3;
    const std::vector<Part> both{{"a", "", 1}, {"b", "", 1}};
    EXPECT_NEAR(roomWanted(plansOf(all, both)).most.metres, 15e-3, 1e-12);
    all.parts.back().first = 0.2e-3;
    EXPECT_NEAR(roomWanted(plansOf(all, both)).most.metres, 3e-3, 1e-12);
    EXPECT_NEAR(roomWanted(plansOf(all, {{"a", "", 1}})).most.metres, 0.6e-3, 1e-12);
    EXPECT_EQ(roomWanted(plansOf(all, both)).most.cells, 0);
    EXPECT_EQ(roomWanted(plansOf(options(3, 1.2), both)).most.metres, 0); // they fill what there is
}

TEST(Layers, GrowByTheRatio) {
    const Sample s;
    for (int count : {1, 2, 5, 12}) {
        for (double growth : {1.0, 1.2, 1.5}) {
            const LayerStack stack = makeLayers(s.front, options(count, growth));
            ASSERT_EQ(stack.validate(s.front), "");
            ASSERT_TRUE(stack.uniform());
            ASSERT_EQ(stack.points(), s.front.front.size() * static_cast<std::size_t>(count));
            for (std::size_t v = 0; v < s.front.front.size(); ++v) {
                const std::vector<double> h = s.heights(stack, v);
                for (std::size_t k = 1; k < h.size(); ++k) EXPECT_NEAR(h[k - 1] / h[k], growth, 1e-9);
                EXPECT_NEAR(std::accumulate(h.begin(), h.end(), 0.0), roomAt(s.front, v), 1e-12 * roomAt(s.front, v));
            }
            const LayerReport report = reportOf(s, stack, count);
            EXPECT_EQ(report.requested, count);
            EXPECT_EQ(report.meanCount, count);
            EXPECT_EQ(report.facesCoveredFraction, 1);
            EXPECT_NEAR(report.thicknessFraction, 1, 1e-6);
        }
    }
}

// Given heights are met to the last digit, and a cell over them takes the rest.
// Few that share the room are neither and many are both, as are those of a height that is small beside the room.
TEST(Layers, AreThinAndFlatWhereManyOrOfSmallHeight) {
    const Sample s;
    struct Row { LayerOptions asked; bool thin, flat; };
    const Row rows[] = {{options(1, 1.2), false, false}, {options(2, 1.2), false, false},  {options(5, 1.2), true, false}, {options(9, 1), true, false},
                        {options(12, 1.2), true, true},  {options(12, 1), true, true},
                        {options(0, 1.2), false, false}, {options(2, 1.2, 0.01 * s.leastRoom()), true, true}, {options(1, 1.2, 3 * s.leastRoom()), false, false}};
    for (const Row& row : rows) {
        const LayerStack stack = makeLayers(s.front, row.asked);
        EXPECT_EQ(stack.areThin(), row.thin) << row.asked.count;
        EXPECT_EQ(stack.areFlat(), row.flat) << row.asked.count;
    }
}

TEST(Layers, HeightsAreMetWhereThereIsRoom) {
    const Sample s;
    const double first = s.leastRoom() / 20; // 5 layers are 7.44 times as high, and half of the last one is 1.04
    const LayerStack stack = makeLayers(s.front, options(5, 1.2, first));
    ASSERT_EQ(stack.validate(s.front), "");
    for (std::size_t f = 0; f < s.faces(); ++f) ASSERT_GE(stack.cellsOf(f), 6); // all have a further cell at least
    for (std::size_t v = 0; v < s.front.front.size(); ++v) {
        const std::vector<double> h = s.fromWall(stack, v);
        for (std::size_t k = 0; k < 5; ++k) EXPECT_NEAR(h[k], first * std::pow(1.2, k), 1e-12);
    }
    const LayerReport report = reportOf(s, stack, 5);
    EXPECT_EQ(report.meanCount, 5);
    EXPECT_NEAR(report.meanFirst, first, 1e-6 * first);
    EXPECT_NEAR(report.minFirst, first, 1e-6 * first);
    EXPECT_NEAR(report.maxFirst, first, 1e-6 * first);
    EXPECT_NEAR(report.thicknessFraction, 1, 1e-6);
    for (const LayerRow& row : report.parts) EXPECT_EQ(row.causes[0], row.faces);
}

// More than fits is squeezed, and the report says how much of it was reached, and why not more.
TEST(Layers, WhatDoesNotFitIsReported) {
    const Sample s;
    const LayerStack stack = makeLayers(s.front, options(3, 1.2, 10 * s.leastRoom()));
    EXPECT_EQ(stack.validate(s.front), "");
    LayerReport report = reportOf(s, stack, 3);
    EXPECT_EQ(report.meanCount, 3);
    EXPECT_GT(report.thicknessFraction, 0);
    EXPECT_LT(report.thicknessFraction, 0.2);
    for (const LayerRow& row : report.parts) EXPECT_EQ(row.causes[std::size_t(LayerCause::room)], row.faces);

    report = reportOf(s, makeLayers(s.front, options(3, 3, s.leastRoom() / 4)), 3); // 13 quarters: less growth helps
    std::int64_t compressed = 0;
    for (const LayerRow& row : report.parts) compressed += row.causes[std::size_t(LayerCause::compressed)];
    EXPECT_GT(compressed, 0);
    EXPECT_NEAR(report.minFirst, s.leastRoom() / 4, 1e-6);
}

// Heights in cell sizes follow the cells, which are of two levels here.
TEST(Layers, RelativeHeightsFollowTheCells) {
    const Sample s;
    LayerOptions o = options(2, 1.5, 0.002);
    o.unit = LayerUnit::cell;
    const LayerStack stack = makeLayers(s.front, o);
    double least = 1e300, most = 0;
    for (std::size_t v = 0; v < s.front.front.size(); ++v) {
        const double first = s.fromWall(stack, v)[0];
        EXPECT_NEAR(first, 0.002 * s.front.h[v], 1e-6 * first);
        least = std::min(least, first), most = std::max(most, first);
    }
    EXPECT_GT(most, 1.9 * least);
}

// Each part has its own count, none included; counts go from one to the next in steps of one, no lower than they must be;
// the heights at the wall are kept throughout.
TEST(Layers, PartsHaveTheirOwnCounts) {
    const Sample s;
    const double first = s.leastRoom() / 40;
    LayerOptions o = options(6, 1.1, first);
    o.parts = {{"[bc]", 2}, {"c", 0}, {"nobody", 3}};
    const WallPlans plans = plansOf(o, s.parts);
    ASSERT_EQ(plans.notes.size(), 1u);
    EXPECT_THAT(plans.notes[0], testing::HasSubstr("nobody"));
    const LayerStack stack = makeLayers(s.front, plans);
    ASSERT_EQ(stack.validate(s.front), "");
    ASSERT_FALSE(stack.uniform());
    const std::array layers{6, 2, 1, 6};
    std::array<int, maxStack> seen{};
    for (std::size_t f = 0; f < s.faces(); ++f) {
        double room = 0;
        int corners = 0;
        for (auto v : s.front.mesh.fv_range(FrontMesh::FaceHandle(static_cast<int>(f)))) room += roomAt(s.front, static_cast<std::size_t>(v.idx())), ++corners;
        const int cells = stack.cellsOf(f), asked = wantedCells(stack.planOfFace(f), room / corners, 1); // with further ones
        EXPECT_GE(asked, layers[static_cast<std::size_t>(s.front.part[f])]);
        ++seen[static_cast<std::size_t>(cells)];
        EXPECT_LE(cells, asked);
        if (cells == asked) continue;
        int least = 99; // lower than asked only for the sake of a neighbour
        for (auto he : s.front.mesh.fh_range(FrontMesh::FaceHandle(static_cast<int>(f)))) {
            const auto other = s.front.mesh.opposite_face_handle(he);
            if (other.is_valid()) least = std::min(least, stack.cellsOf(static_cast<std::size_t>(other.idx())));
        }
        EXPECT_EQ(cells, least + 1);
    }
    for (std::size_t cells : {1, 2, 3}) EXPECT_GT(seen[cells], 0) << cells;
    for (std::size_t v = 0; v < s.front.front.size(); ++v) {
        const std::vector<double> h = s.fromWall(stack, v);
        const auto all = static_cast<std::size_t>(stack.planOfVertex(v).count);
        for (std::size_t k = 0; k + 1 < h.size() && k < all; ++k) EXPECT_NEAR(h[k], first * std::pow(1.1, k), 1e-12);
    }
    const LayerReport report = reportOf(s, stack, 6);
    ASSERT_EQ(report.parts.size(), 4u);
    EXPECT_EQ(report.parts[1].asked, 2);
    EXPECT_EQ(report.parts[2].asked, 0);
    EXPECT_EQ(report.parts[2].meanCount, 0);
    EXPECT_EQ(report.parts[2].causes[0], report.parts[2].faces);
    EXPECT_LT(report.facesCoveredFraction, 1);
    EXPECT_GT(report.parts[0].causes[std::size_t(LayerCause::taper)], 0);
    EXPECT_LT(report.parts[0].meanCount, 6);
    EXPECT_NEAR(report.parts[0].askedThickness, stackHeight(first, 1.1, 6), 1e-6);
}

TEST(Layers, AreTheSameOnAnyNumberOfThreads) {
    const Sample s;
    LayerOptions o = options(9, 1.2, s.leastRoom() / 30);
    o.parts = {{"b", 1}, {"d", 0}};
    const LayerStack one = makeLayers(s.front, plansOf(o, s.parts));
    for (std::size_t threads : {1, 2, 3}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        const LayerStack again = makeLayers(s.front, plansOf(o, s.parts));
        EXPECT_EQ(again.cellOffsets, one.cellOffsets);
        EXPECT_EQ(again.pointOffsets, one.pointOffsets);
        EXPECT_EQ(again.vertexPlan, one.vertexPlan);
    }
}

// Points are found again by their number.
TEST(Layers, PointsKnowTheirVertex) {
    const Sample s;
    LayerOptions o = options(4, 1.2);
    o.parts = {{"a", 1}};
    for (const LayerStack& stack : {makeLayers(s.front, options(3, 1.2)), makeLayers(s.front, plansOf(o, s.parts))}) {
        for (std::size_t v = 0; v < stack.vertices; ++v) {
            for (int k = 0; k < stack.pointsOf(v); ++k) ASSERT_EQ(stack.vertexOfPoint(stack.pointOffset(v) + static_cast<std::size_t>(k)), v);
        }
        EXPECT_EQ(stack.pointOffset(stack.vertices - 1) + static_cast<std::size_t>(stack.pointsOf(stack.vertices - 1)), stack.points());
    }
}

TEST(Layers, ValidateNamesTheFault) {
    const Sample s;
    LayerOptions o = options(4, 1.2);
    o.parts = {{"a", 1}};
    const LayerStack sound = makeLayers(s.front, plansOf(o, s.parts));
    ASSERT_EQ(sound.validate(s.front), "");
    LayerStack stack = sound;
    stack.pointOffsets.pop_back();
    EXPECT_THAT(stack.validate(s.front), testing::HasSubstr("sizes"));
    stack = sound;
    for (std::size_t f = 40; f < stack.cellOffsets.size(); ++f) stack.cellOffsets[f] += 2;
    EXPECT_THAT(stack.validate(s.front), testing::AnyOf(testing::HasSubstr("differ"), testing::HasSubstr("points where")));
    stack = sound;
    stack.plans[0].growth = -1;
    EXPECT_THAT(stack.validate(s.front), testing::HasSubstr("do not fall"));
}

// Cells that have become one count once in their stack, and the report says why there are fewer; what hangs on cells at the
// wall stays in the order of cells.
TEST(LayerReport, CountsMergedCellsOnce) {
    Sample s;
    LayerOptions options;
    options.count = 3;
    const LayerStack stack = makeLayers(s.front, options);
    ASSERT_TRUE(stack.uniform());
    constexpr std::int32_t core = 100;
    const auto cells = static_cast<std::size_t>(core) + stack.cells();
    const auto cellOf = [&](std::size_t face, int cell) { return static_cast<std::size_t>(core) + stack.cellOffset(face) + static_cast<std::size_t>(cell); };
    std::vector<std::int32_t> number(cells);
    std::iota(number.begin(), number.end(), 0);
    number[cellOf(2, 2)] = number[cellOf(2, 1)];  // two of a stack
    number[cellOf(5, 2)] = number[cellOf(4, 2)];  // side by side, at the wall
    number[cellOf(7, 0)] = 3;                     // with a cell of the core
    const WallLayers before = measureLayers(s.front, stack);
    WallLayers walls = before;
    settleCells(walls, stack, core, number, {static_cast<std::int32_t>(cellOf(6, 2))});
    for (std::size_t f = 0; f < s.faces(); ++f) {
        EXPECT_EQ(walls.achieved[f], f == 2 ? 2 : before.achieved[f]) << f;
        EXPECT_EQ(walls.cause[f], f == 2 ? LayerCause::merged : before.cause[f]) << f;
        EXPECT_EQ(walls.wallCell[f], number[cellOf(f, 2)]) << f;
    }
    const LayerReport report = summarize(walls, s.front, s.parts, 3);
    std::int64_t merged = 0;
    for (const LayerRow& row : report.parts) merged += row.causes[static_cast<std::size_t>(LayerCause::merged)];
    EXPECT_EQ(merged, 1);
    EXPECT_EQ(std::accumulate(report.parts.begin(), report.parts.end(), std::int64_t(0), [](std::int64_t n, const LayerRow& row) { return n + row.faces; }),
              static_cast<std::int64_t>(s.faces()) + 1); // one of them in two pieces
    number[cellOf(7, 2)] = 3; // now the wall's cell is one of the core, before all others
    walls = before;
    settleCells(walls, stack, core, number, {});
    sortByCell(walls);
    EXPECT_EQ(walls.wallCell.size(), s.faces() - 1);
    EXPECT_TRUE(std::ranges::adjacent_find(walls.wallCell, std::ranges::greater_equal()) == walls.wallCell.end());
    EXPECT_EQ(walls.wallCell.front(), 3);
    EXPECT_EQ(walls.first.front(), before.first[7]);
    WallLayers same = before;
    settleCells(same, stack, core, {}, {});
    sortByCell(same);
    EXPECT_EQ(same.first, before.first);
}

} // namespace
} // namespace i2b::test
