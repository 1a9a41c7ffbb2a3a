// Proves: layer heights fall towards the wall by the growth ratio, or meet the first height asked for where
// there is room, and always fill the way from front to wall.
#include "carve/kept_checks.h"
#include "i2b/layers/layer_stack.h"
#include <gtest/gtest.h>

namespace i2b::test {
namespace {

struct Sample {
    Sample()
        : carved(3, {5, 6, 4}, 2, 1, 0.1), lattice(carved.grid, carved.kept),
          front(buildFront(lattice, 0.07)) {}
    double room(std::size_t v) const {
        const auto& p = front.mesh.point(FrontMesh::VertexHandle(static_cast<int>(v)));
        return norm(Vec3{p[0], p[1], p[2]} - front.front[v]);
    }
    // Heights of vertex v's layers, front to wall.
    std::vector<double> heights(const LayerStack& s, std::size_t v) const {
        std::vector<double> h;
        double below = 0;
        for (int k = 0; k < s.count; ++k) {
            h.push_back((double(s.fraction(v, k)) - below) * room(v));
            below = double(s.fraction(v, k));
        }
        return h;
    }
    CarvedAtRandom carved;
    LatticeMesh lattice;
    Front front;
};

LayerOptions options(int count, double growth, double first = 0) {
    LayerOptions o;
    o.count = count, o.growth = growth, o.first = first;
    return o;
}

TEST(Layers, GrowByTheRatio) {
    const Sample s;
    for (int count : {1, 2, 5, 12}) {
        for (double growth : {1.0, 1.2, 1.5}) {
            const LayerStack stack = makeLayers(s.front, options(count, growth));
            ASSERT_EQ(stack.validate(), "");
            ASSERT_EQ(stack.fractions.size(), s.front.front.size() * static_cast<std::size_t>(count));
            EXPECT_EQ(stack.requested, count);
            EXPECT_EQ(stack.meanCount, count);
            EXPECT_EQ(stack.facesCovered, 1);
            double first = 0;
            for (std::size_t v = 0; v < s.front.front.size(); ++v) {
                const std::vector<double> h = s.heights(stack, v);
                double sum = 0;
                for (std::size_t k = 0; k < h.size(); ++k) {
                    sum += h[k];
                    EXPECT_NEAR(k > 0 ? h[k - 1] / h[k] : growth, growth, 1e-3); // fractions are floats
                }
                EXPECT_NEAR(sum, s.room(v), 1e-6 * s.room(v));
                first += h.back() / static_cast<double>(s.front.front.size());
            }
            EXPECT_NEAR(stack.meanFirstHeight, first, 1e-5 * first);
        }
    }
}

TEST(Layers, FirstHeightIsMetWhereThereIsRoom) {
    const Sample s;
    double least = s.room(0), most = s.room(0);
    for (std::size_t v = 0; v < s.front.front.size(); ++v)
        least = std::min(least, s.room(v)), most = std::max(most, s.room(v));
    const double first = least / 8; // 5 layers fill the room with ratios between 1/2 and 4 everywhere
    ASSERT_LT(most, 300 * first);
    const LayerStack stack = makeLayers(s.front, options(5, 1.2, first));
    ASSERT_EQ(stack.validate(), "");
    for (std::size_t v = 0; v < s.front.front.size(); ++v) {
        const std::vector<double> h = s.heights(stack, v);
        EXPECT_NEAR(h.back(), first, 1e-4 * s.room(v));
        for (std::size_t k = 2; k < h.size(); ++k) EXPECT_NEAR(h[k - 1] / h[k], h[0] / h[1], 1e-2);
    }
}

// More than fits is squeezed, and the report says how much of it was reached.
TEST(Layers, WhatDoesNotFitIsReported) {
    const Sample s;
    double most = 0;
    for (std::size_t v = 0; v < s.front.front.size(); ++v) most = std::max(most, s.room(v));
    const LayerStack stack = makeLayers(s.front, options(3, 1.2, 10 * most));
    EXPECT_EQ(stack.validate(), "");
    EXPECT_GT(stack.thicknessFraction, 0);
    EXPECT_LT(stack.thicknessFraction, 0.05);
    EXPECT_EQ(makeLayers(s.front, options(3, 1.2)).thicknessFraction, 1);
}

TEST(Layers, ValidateNamesTheFault) {
    const Sample s;
    LayerStack stack = makeLayers(s.front, options(3, 1.2));
    std::swap(stack.fractions[0], stack.fractions[1]);
    EXPECT_NE(stack.validate(), "");
}

} // namespace
} // namespace i2b::test
