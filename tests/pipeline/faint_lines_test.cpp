// Proves: the wall has edges along lines at which the geometry folds little or not at all, where its user asks for them: lines drawn on
// flat and on curved walls, flat borders of named parts, edges over a small feature angle; at random poses, with all checks passed and
// the same on any number of threads.
#include "i2b/program/generate.h"
#include "i2b/samples/sample.h"
#include "pipeline/pose.h"
#include "pipeline/shape_run.h"
#include "pipeline/stages_run.h"
#include "pipeline/temporary_stl.h"
#include "temp_folder.h"
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <numbers>
#include <tbb/global_control.h>

namespace i2b::test {
namespace {

constexpr double h = 0.08; // m
constexpr unsigned poses = 4;

struct Drawing {
    const char* name;
    Surface soup;
    std::vector<std::vector<Vec3>> lines = {}; // polylines, m
    std::vector<std::string> parts = {};
    double angle = 40;
};

Surface slab() {
    Surface s;
    addPart(s, samples::box({-1, -0.8, -0.3}, {1, 0.8, 0.3}), "slab");
    return s;
}

std::vector<Vec3> circle(const Vec3& centre, const Vec3& a, const Vec3& b, int n) {
    std::vector<Vec3> line;
    for (int i = 0; i <= n; ++i) {
        const double angle = 2 * std::numbers::pi * (i % n) / n;
        line.push_back(centre + a * std::cos(angle) + b * std::sin(angle));
    }
    return line;
}

Drawing frame() { return {"frame", slab(), {{{-0.6, -0.4, 0.3}, {0.5, -0.5, 0.3}, {0.6, 0.4, 0.3}, {-0.5, 0.5, 0.3}, {-0.6, -0.4, 0.3}}}}; }
Drawing ring() { return {"ring", slab(), {circle({0.1, 0.05, 0.3}, {0.5, 0, 0}, {0, 0.5, 0}, 40)}}; }
Drawing girdle() { // over all of a slab, across its sharp edges
    return {"girdle", slab(), {{{-0.3, -0.8, -0.3}, {0.2, -0.8, 0.3}, {0.4, 0.8, 0.3}, {-0.1, 0.8, -0.3}, {-0.3, -0.8, -0.3}}}};
}
Drawing equator() { return {"equator", makeSample("sphere", {.dirt = 0, .resolution = 4}), {circle({}, {0.5, 0, 0}, {0, 0.3, 0.4}, 120)}}; }

// Two parts with one flat top, whose border is askew.
Drawing border() {
    Surface s;
    const std::vector<Vec3> points{{-1, -0.8, 0.3}, {0.1, -0.8, 0.3}, {-0.2, 0.8, 0.3}, {-1, 0.8, 0.3}, {1, -0.8, 0.3}, {1, 0.8, 0.3}};
    s.points = points;
    for (Vec3 p : points) s.points.push_back({p.x, p.y, -0.3});
    const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d, std::int32_t part) {
        s.triangles.push_back({a, b, c}), s.triangles.push_back({a, c, d});
        s.partOf.insert(s.partOf.end(), {part, part});
    };
    quad(0, 1, 2, 3, 0), quad(1, 4, 5, 2, 1);
    quad(6, 9, 8, 7, 2), quad(7, 8, 11, 10, 2), quad(0, 6, 7, 1, 2), quad(1, 7, 10, 4, 2), quad(4, 10, 11, 5, 2), quad(5, 11, 8, 2, 2), quad(2, 8, 9, 3, 2), quad(3, 9, 6, 0, 2);
    s.parts = {{"left", "", 4}, {"right", "", 4}, {"rest", "", 16}};
    return {"border", s, {}, {"left"}};
}

// A slab whose top is a roof that folds by 20 degrees.
Drawing roof() {
    Drawing d{"roof", slab(), {}, {}, 15};
    const double rise = 0.8 * std::tan(10 * std::numbers::pi / 180);
    d.soup.points = {{-1, -0.8, -0.3}, {1, -0.8, -0.3}, {1, 0.8, -0.3}, {-1, 0.8, -0.3}, {-1, -0.8, 0.2}, {1, -0.8, 0.2}, {1, 0.8, 0.2}, {-1, 0.8, 0.2}, {-1, 0, 0.2 + rise}, {1, 0, 0.2 + rise}};
    d.soup.triangles = {{0, 2, 1}, {0, 3, 2}, {0, 1, 5}, {0, 5, 4}, {2, 3, 7}, {2, 7, 6}, {4, 5, 9}, {4, 9, 8}, {6, 7, 8}, {6, 8, 9}, {1, 2, 6}, {1, 6, 9}, {1, 9, 5}, {3, 0, 4}, {3, 4, 8}, {3, 8, 7}};
    d.soup.partOf.assign(d.soup.triangles.size(), 0);
    d.soup.parts = {{"roof", "", d.soup.triangles.size()}};
    return d;
}

class FaintLines : public testing::TestWithParam<Drawing (*)()> {};

std::string objOf(const std::vector<std::vector<Vec3>>& lines, const Pose& pose) {
    std::string text;
    std::size_t n = 0;
    for (const auto& line : lines) {
        std::string ends = "l";
        for (const Vec3& p : line) {
            const Vec3 q = pose(p);
            text += fmt::format("v {:.17g} {:.17g} {:.17g}\n", q.x, q.y, q.z);
            ends += fmt::format(" {}", ++n);
        }
        text += ends + "\n";
    }
    return text;
}

MeshResult meshOf(Drawing d, unsigned seed) {
    const Pose pose(d.name, h, seed);
    for (Vec3& p : d.soup.points) p = pose(p);
    const TempFolder folder;
    const TemporaryStl file(d.soup, seed);
    Options options;
    options.geometry.files = {file.path()};
    if (!d.lines.empty()) options.geometry.featureLines = {folder.write("lines.obj", objOf(d.lines, pose))};
    options.geometry.featureParts = d.parts;
    options.geometry.featureAngle = d.angle;
    options.size.surface = h, options.size.max = 4 * h;
    options.domain.box = Box{{-1.92, -1.92, -1.92}, {1.92, 1.92, 1.92}};
    Context context;
    return generate(options, context);
}

TEST_P(FaintLines, AreFollowed) {
    for (unsigned seed = 0; seed < poses; ++seed) {
        SCOPED_TRACE(seed);
        const MeshResult mesh = meshOf(GetParam()(), seed);
        EXPECT_EQ(mesh.mesh.validate(), "");
        EXPECT_EQ(plainFailures(*mesh.report.quality), "");
        EXPECT_EQ(mesh.report.quality->dictionaryFaces, 0);
        EXPECT_GT(mesh.report.fit->faintSamples, 20);
        EXPECT_GE(mesh.report.fit->faintCaptureFraction, 0.97);
        EXPECT_GE(mesh.report.fit->featureCaptureFraction, 0.97);
        EXPECT_GE(mesh.report.fit->wallNodesOnGeometryFraction, 0.99);
    }
}

TEST(FaintLine, AreTheSameOnAnyNumberOfThreads) {
    const std::uint64_t checksum = meshOf(girdle(), 1).mesh.checksum();
    for (const std::size_t threads : {1, 3}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        EXPECT_EQ(meshOf(girdle(), 1).mesh.checksum(), checksum);
    }
}

INSTANTIATE_TEST_SUITE_P(Drawings, FaintLines, testing::Values(&frame, &ring, &girdle, &equator, &border, &roof),
                         [](const auto& tested) { return std::string(tested.param().name); });

} // namespace
} // namespace i2b::test
