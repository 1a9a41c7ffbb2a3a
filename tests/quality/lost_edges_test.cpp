// gatherLostEdges of samples placed by hand, beside two parts.
#include "i2b/quality/lost_edges.h"
#include <gtest/gtest.h>
#include <tbb/global_control.h>

namespace i2b {
namespace {

constexpr double h = 0.1;

// Two triangles, at y = 0 and at y = 10.
Surface twoParts() {
    Surface s;
    s.parts = {{"near", "", 1}, {"far", "", 1}};
    s.points = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {0, 10, 0}, {1, 10, 0}, {0, 10, 1}};
    s.triangles = {{0, 1, 2}, {3, 4, 5}};
    s.partOf = {0, 1};
    return s;
}

LostSample sampleOf(const Vec3& point, double size) { return {point, 0, {-1, size, 0, {}}}; }

std::vector<LostCause> allCrossed(const std::vector<LostSample>& samples) { return std::vector(samples.size(), LostCause::crossed); }

void addStretch(std::vector<LostSample>& samples, const Vec3& from, int count) {
    for (int i = 0; i < count; ++i) samples.push_back(sampleOf(from + Vec3{i * h / 4, 0, 0}, h));
}

// Samples h/4 apart are one place, as long as its samples stand for; what lies over h/2 away is another. The longest comes first.
TEST(LostEdges, HangTogetherInPlaces) {
    std::vector<LostSample> samples;
    addStretch(samples, {0, 0, 0}, 4), addStretch(samples, {0.5, 0, 0}, 7), addStretch(samples, {0, 10, 0}, 4);
    const Surface surface = twoParts();
    const LostEdges lost = gatherLostEdges(samples, allCrossed(samples), SurfaceIndex(surface));
    EXPECT_NEAR(lost.length(), 15 * h / 4, 1e-12);
    ASSERT_EQ(lost.total, 3);
    ASSERT_EQ(lost.first.size(), 3u);
    EXPECT_NEAR(lost.first[0].length, 7 * h / 4, 1e-12);
    EXPECT_EQ(lost.first[0].at, samples[7].point);
    EXPECT_EQ(lost.first[0].box.lo, samples[4].point);
    EXPECT_EQ(lost.first[0].box.hi, samples[10].point);
    EXPECT_EQ(lost.first[0].part, "near");
    EXPECT_EQ(lost.first[1].part, "near"); // of two as long the one that comes first
    EXPECT_EQ(lost.first[2].part, "far");
}

// Lines that meet are one place, whatever their order; no more places are kept than asked for, but all are counted.
TEST(LostEdges, CountsPlacesThatItDoesNotKeep) {
    std::vector<LostSample> samples;
    addStretch(samples, {0, 0, 0}, 3), addStretch(samples, {5, 0, 0}, 3), addStretch(samples, {0.75 * h, 0, 0}, 3);
    const Surface surface = twoParts();
    const LostEdges lost = gatherLostEdges(samples, allCrossed(samples), SurfaceIndex(surface), 1);
    EXPECT_EQ(lost.total, 2);
    ASSERT_EQ(lost.first.size(), 1u);
    EXPECT_NEAR(lost.first[0].length, 6 * h / 4, 1e-12);
    EXPECT_EQ(gatherLostEdges({}, {}, SurfaceIndex(surface)).total, 0);
}

// The cause of a place is that of most of its samples; the lengths by cause are those of samples.
TEST(LostEdges, HaveTheCauseOfMost) {
    std::vector<LostSample> samples;
    addStretch(samples, {0, 0, 0}, 3), addStretch(samples, {5, 0, 0}, 2);
    using enum LostCause;
    const Surface surface = twoParts();
    const LostEdges lost = gatherLostEdges(samples, {bridged, crossed, bridged, leftOut, leftOut}, SurfaceIndex(surface));
    ASSERT_EQ(lost.total, 2);
    EXPECT_EQ(lost.first[0].cause, bridged);
    EXPECT_EQ(lost.first[1].cause, leftOut);
    EXPECT_NEAR(lost.lengthOf[std::size_t(crossed)], h / 4, 1e-12);
    EXPECT_NEAR(lost.lengthOf[std::size_t(bridged)], h / 2, 1e-12);
    EXPECT_NEAR(lost.lengthOf[std::size_t(leftOut)], h / 2, 1e-12);
    EXPECT_EQ(lost.lengthOf[std::size_t(shallow)], 0);
}

TEST(LostEdges, AreTheSameOnAnyNumberOfThreads) {
    std::vector<LostSample> samples;
    for (int i = 0; i < 500; ++i) samples.push_back(sampleOf({(i * 7919 % 1000) * 0.01, (i * 104729 % 1000) * 0.01, 0}, h + 0.001 * (i % 100)));
    const Surface surface = twoParts();
    const SurfaceIndex index(surface);
    const LostEdges all = gatherLostEdges(samples, allCrossed(samples), index);
    EXPECT_GT(all.total, 50);
    for (const std::size_t threads : {1u, 3u, 8u}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        const LostEdges again = gatherLostEdges(samples, allCrossed(samples), index);
        ASSERT_EQ(again.total, all.total);
        EXPECT_EQ(again.length(), all.length());
        for (std::size_t i = 0; i < all.first.size(); ++i) {
            EXPECT_EQ(again.first[i].length, all.first[i].length);
            EXPECT_EQ(again.first[i].at, all.first[i].at);
        }
    }
}

} // namespace
} // namespace i2b
