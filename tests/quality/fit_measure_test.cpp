// measureFit on walls whose every figure can be worked out by hand: a unit cube with n x n faces a side.
#include "i2b/geometry/rims.h"
#include "i2b/quality/fit_report.h"
#include <functional>
#include <gtest/gtest.h>
#include <map>
#include <tbb/global_control.h>

namespace i2b {
namespace {

constexpr int n = 10;
constexpr double h = 1.0 / n;

// Corner (0, 0, 0) and (1, 1, size): 12 triangles, every third turned around.
Surface box(double height) {
    Surface s;
    s.parts.push_back({"box", "", 12});
    for (int i = 0; i < 8; ++i)
        s.points.push_back({double(i & 1), double(i >> 1 & 1), height * (i >> 2 & 1)});
    const std::uint32_t f[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                   {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    for (const auto& q : f) {
        s.triangles.push_back({q[0], q[1], q[2]});
        s.triangles.push_back({q[0], q[2], q[3]});
    }
    for (std::size_t t = 0; t < 12; t += 3) std::swap(s.triangles[t][0], s.triangles[t][1]);
    s.partOf.assign(12, 0);
    return s;
}

// The boundary faces of a cube cut into n^3; move() places the points of that grid. z = 1 is a patch of its
// own.
PolyMesh cubeWall(const std::function<Vec3(Vec3)>& move) {
    PolyMesh m;
    m.cells = 1;
    m.faceOffsets.push_back(0);
    std::map<std::array<int, 3>, std::int32_t> numbers;
    const auto point = [&](const std::array<int, 3>& p) {
        const auto [at, isNew] = numbers.try_emplace(p, static_cast<std::int32_t>(m.points.size()));
        if (isNew) m.points.push_back(move({p[0] * h, p[1] * h, p[2] * h}));
        return at->second;
    };
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (int side = 0; side < 2; ++side)
            for (int j = 0; j < n; ++j)
                for (int i = 0; i < n; ++i)
                    for (int k = 0; k < 4; ++k) {
                        std::array<int, 3> p{};
                        p[axis] = side * n;
                        const int du = k == 1 || k == 2, dv = k >= 2; // a loop, reversed on the low side
                        p[(axis + 1) % 3] = i + (side ? du : dv);
                        p[(axis + 2) % 3] = j + (side ? dv : du);
                        m.faceVertices.push_back(point(p));
                        if (k == 3) {
                            m.faceOffsets.push_back(static_cast<std::uint32_t>(m.faceVertices.size()));
                            m.owner.push_back(0);
                        }
                    }
    m.patches = {{"body", "wall", 0, 5 * n * n}, {"top", "patch", 5 * n * n, n * n}};
    return m;
}

FitReport fit(const PolyMesh& mesh, const Surface& surface,
              const std::vector<std::string>& patches = {"body", "top"}) {
    const SurfaceIndex index(surface);
    const Rows cellFaces = buildCellFaces(mesh);
    FitReport report = measureFit(mesh, cellFaces, index, buildFeatureGraph(surface, {}), patches);
    measurePartBorders(mesh, cellFaces, index, patches, report);
    return report;
}

// A wall exactly on the geometry gets full marks, and the samples are those of the definition: every h/4 of
// 12 edges, without the h at either end, where the edges that meet in the corner are too near.
TEST(FitMeasure, exact) {
    const FitReport r = fit(cubeWall([](Vec3 p) { return p; }), box(1));
    EXPECT_EQ(r.wallFaces, 6 * n * n);
    EXPECT_EQ(r.wallNodes, 6 * n * n + 2);
    EXPECT_EQ(r.wallNodesWithin0001h, 1);
    EXPECT_EQ(r.wallNodesOnGeometryFraction, 1);
    EXPECT_EQ(r.wallNodesWithin01h, 1);
    EXPECT_NEAR(r.meanDistanceInH, 0, 1e-12);
    EXPECT_NEAR(r.maxDistanceInH, 0, 1e-12);
    EXPECT_EQ(r.featureCaptureFraction, 1);
    EXPECT_NEAR(double(r.featureSamples), 12 * (4 * n - 8), 24);
    EXPECT_EQ(r.tiltedFaceFraction, 0);
}

// Shifted by 0.05 h along x: the nodes of the side x = 1 are off by that, and those of x = 0 but for its rim,
// which slides along the other sides. The edges are still within 0.1 h.
TEST(FitMeasure, shiftedALittle) {
    const FitReport r = fit(cubeWall([](Vec3 p) { return p + Vec3{0.05 * h, 0, 0}; }), box(1));
    const double off = (n + 1) * (n + 1) + (n - 1) * (n - 1);
    EXPECT_NEAR(r.wallNodesOnGeometryFraction, 1 - off / (6 * n * n + 2), 1e-12);
    EXPECT_EQ(r.wallNodesWithin0001h, r.wallNodesOnGeometryFraction);
    EXPECT_EQ(r.wallNodesWithin01h, 1);
    EXPECT_NEAR(r.maxDistanceInH, 0.05, 1e-9);
    EXPECT_NEAR(r.meanDistanceInH, 0.05 / 3, 1e-9);
    const Surface surface = box(1);
    EXPECT_NEAR(SurfaceIndex(surface).closest(r.farthest).distance, 0.05 * h, 1e-12);
    EXPECT_EQ(r.featureCaptureFraction, 1);
    EXPECT_EQ(r.tiltedFaceFraction, 0);
}

// Beside the rims of z = 1 a row of faces without width: a node there has two of them and two of the top, and the size of
// the wall is the length of the strips, not their width. Samples are as many as without them.
TEST(FitMeasure, stripsCountWithTheirLength) {
    const auto squeezed = [](Vec3 p) { return p.z > 1 - 1.5 * h && p.z < 1 - 0.5 * h ? Vec3{p.x, p.y, 1 - 0.01 * h} : p; };
    const FitReport plain = fit(cubeWall([](Vec3 p) { return p; }), box(1)), r = fit(cubeWall(squeezed), box(1));
    EXPECT_EQ(r.wallNodesOnGeometryFraction, 1);
    EXPECT_EQ(r.featureCaptureFraction, 1);
    EXPECT_NEAR(double(r.featureSamples), double(plain.featureSamples), 24);
}

// Shifted by 0.2 h along x: only the four edges along x are still captured.
TEST(FitMeasure, shiftedFarther) {
    const FitReport r = fit(cubeWall([](Vec3 p) { return p + Vec3{0.2 * h, 0, 0}; }), box(1));
    EXPECT_NEAR(r.featureCaptureFraction, 4.0 / 12, 0.02);
    EXPECT_NEAR(r.maxDistanceInH, 0.2, 1e-9);
    EXPECT_LT(r.wallNodesWithin01h, 1);
}

// Edges cut off: the wall comes near them (within h/2) but has no edge there. Its faces next to them are
// steep, but too near to count as tilted.
TEST(FitMeasure, chamfered) {
    const auto inwards = [](double x) { return x < h / 2 ? 0.2 * h : x > 1 - h / 2 ? -0.2 * h : 0; };
    const FitReport r = fit(cubeWall([&](Vec3 p) {
                                const Vec3 d{inwards(p.x), inwards(p.y), inwards(p.z)};
                                const int sides = (d.x != 0) + (d.y != 0) + (d.z != 0);
                                return sides > 1 ? p + d : p;
                            }),
                            box(1));
    EXPECT_GT(r.featureSamples, 300);
    EXPECT_EQ(r.featureCaptureFraction, 0);
    EXPECT_EQ(r.tiltedFaceFraction, 0);
}

// A line drawn on a flat side is captured where the wall has an edge along it, not where its faces have their middle, nor where its edges
// cross it; one off the geometry is none.
TEST(FitMeasure, faintLines) {
    const PolyMesh mesh = cubeWall([](Vec3 p) { return p; });
    const Surface surface = box(1);
    const auto measured = [&](const Vec3& a, const Vec3& b) {
        const FeatureGraph features = buildFeatureGraph(surface, {.lines = {{a, b}, {{0, 1}}, {}}});
        return measureFit(mesh, buildCellFaces(mesh), SurfaceIndex(surface), features, {"body", "top"});
    };
    const FitReport along = measured({0.2, 0.5, 1}, {0.8, 0.5, 1});
    EXPECT_NEAR(double(along.faintSamples), 4 * 6, 2);
    EXPECT_EQ(along.faintCaptureFraction, 1);
    EXPECT_EQ(along.featureCaptureFraction, 1);
    EXPECT_EQ(measured({0.2, 0.55, 1}, {0.8, 0.55, 1}).faintCaptureFraction, 0);
    EXPECT_EQ(measured({0.25, 0.3, 1}, {0.65, 0.7, 1}).faintCaptureFraction, 0);
    EXPECT_EQ(measured({0.2, 0.5, 1.01}, {0.8, 0.5, 1.01}).faintSamples, 0);
    EXPECT_EQ(fit(mesh, surface).faintSamples, 0);
}

// One node pulled 0.8 h out of the middle of a side tilts its four faces by 29 degrees, 2 h tilt them by 55;
// the faces along the edges, whose centre is within h, are not counted.
TEST(FitMeasure, tilted) {
    const auto pulled = [](double by) {
        return cubeWall([by](Vec3 p) {
            const bool one = std::abs(p.x - 0.5) + std::abs(p.y - 0.5) < h / 2 && p.z < h / 2;
            return one ? p - Vec3{0, 0, by * h} : p;
        });
    };
    const double counted = 6 * (n - 2) * (n - 2);
    FitReport r = fit(pulled(0.8), box(1));
    EXPECT_NEAR(r.tiltedFaceFraction, 4 / counted, 1e-12);
    EXPECT_EQ(r.tilted45FaceFraction, 0);
    EXPECT_NEAR(r.maxDistanceInH, 0.8, 1e-9);
    r = fit(pulled(0.6), box(1));
    EXPECT_EQ(r.tiltedFaceFraction, 0);
    r = fit(pulled(2), box(1));
    EXPECT_NEAR(r.tilted45FaceFraction, 4 / counted, 1e-12);
}

// The rim of a plate thinner than a cell cannot be resolved: it is not asked for. Nor are edges that no wall
// reaches.
TEST(FitMeasure, onlyResolvableEdgesAreAskedFor) {
    const PolyMesh flat = cubeWall([](Vec3 p) { return Vec3{p.x, p.y, p.z * 0.3 * h}; });
    EXPECT_GT(fit(cubeWall([](Vec3 p) { return p; }), box(1), {"top"}).featureSamples, 100);
    EXPECT_EQ(fit(flat, box(0.3 * h), {"top"}).featureSamples, 0);
    const PolyMesh away = cubeWall([](Vec3 p) { return Vec3{0.2, 0.2, 0.2} + p * 0.6; });
    const FitReport r = fit(away, box(1));
    EXPECT_EQ(r.featureSamples, 0);
    EXPECT_EQ(r.featureCaptureFraction, 1);
}

// Without names the patches of type wall are measured; without any there is nothing to report.
TEST(FitMeasure, patches) {
    const PolyMesh mesh = cubeWall([](Vec3 p) { return p; });
    const Surface surface = box(1);
    EXPECT_EQ(fit(mesh, surface, {}).wallFaces, 5 * n * n);
    EXPECT_EQ(fit(mesh, surface, {"top"}).wallFaces, n * n);
    EXPECT_EQ(fit(mesh, surface, {"nothing"}).wallFaces, 0);
    EXPECT_EQ(fit(mesh, Surface{}).wallNodesOnGeometryFraction, 1);
}

// Where the wall ends at a side of the domain the mesh has an edge as sharp as the two fold there: the edges of a box's top count as
// captured whether the top is wall or not, unless the other patch goes on where the wall ends.
TEST(FitMeasure, edgesAtTheSidesOfTheDomain) {
    const PolyMesh mesh = cubeWall([](Vec3 p) { return p; });
    const FitReport all = fit(mesh, box(1)), ends = fit(mesh, box(1), {"body"});
    EXPECT_EQ(ends.featureSamples, all.featureSamples);
    EXPECT_EQ(ends.featureCaptureFraction, 1);
    // A side of the cube is cut in two patches: its middle line is no edge of the mesh, whatever the geometry says.
    PolyMesh cut = mesh;
    cut.patches = {{"body", "wall", 0, n * n / 2}, {"rest", "patch", n * n / 2, 6 * n * n - n * n / 2}};
    Surface wedge; // folds by 90 degrees along that line
    wedge.parts.push_back({"wedge", "", 2});
    wedge.points = {{0, 0, 0}, {0, 1, 0}, {0, 1, 0.5}, {0, 0, 0.5}, {-1, 1, 0.5}, {-1, 0, 0.5}};
    wedge.triangles = {{0, 1, 2}, {0, 2, 3}, {3, 2, 4}, {3, 4, 5}};
    wedge.partOf.assign(4, 0);
    const FitReport flat = fit(cut, wedge, {"body"});
    EXPECT_GT(flat.featureSamples, 0);
    EXPECT_LT(flat.featureCaptureFraction, 0.1);
}

// The box with its top, and the border between the two parts at a height; neither has a side there.
Surface boxOfTwo(double border) {
    Surface s;
    s.parts = {{"body", "", 10}, {"top", "", 10}};
    for (int part = 0; part < 2; ++part) {
        const Surface piece = box(part ? 1 - border : border);
        const double open = part ? 0 : border; // height of the side that is left out
        const auto first = static_cast<std::uint32_t>(s.points.size());
        for (const Vec3& p : piece.points) s.points.push_back({p.x, p.y, p.z + (part ? border : 0)});
        for (const auto& v : piece.triangles) {
            if (std::all_of(v.begin(), v.end(), [&](std::uint32_t i) { return piece.points[i].z == open; })) continue;
            s.triangles.push_back({first + v[0], first + v[1], first + v[2]});
            s.partOf.push_back(part);
        }
    }
    return s;
}

// The top is a part of its own: samples every h/4 along the 4 edges around it, not within h of the corners. Each
// is sampled twice, since both parts have edges there. With the geometry's border a quarter of a cell below none is captured.
TEST(FitMeasure, bordersBetweenParts) {
    PolyMesh mesh = cubeWall([](Vec3 p) { return p; });
    const FitReport on = fit(mesh, boxOfTwo(1 - 1e-6)), off = fit(mesh, boxOfTwo(1 - 0.25 * h));
    EXPECT_NEAR(double(on.borderSamples), 2 * 4 * (4 * n - 8), 16);
    EXPECT_DOUBLE_EQ(on.partBorderFraction, 1);
    EXPECT_NEAR(double(off.borderSamples), 2 * 4 * (4 * n - 8), 16);
    EXPECT_DOUBLE_EQ(off.partBorderFraction, 0);
    EXPECT_EQ(fit(mesh, box(1)).borderSamples, 0);
}

// A foot that stands on the top: the border is its outline, which only the foot has edges along. A sheet that passes through
// two sides: the border is where it cuts them. Neither is on the wall's edges.
TEST(FitMeasure, bordersOfWhatStandsOnOrPassesThrough) {
    const PolyMesh mesh = cubeWall([](Vec3 p) { return p; });
    const auto with = [&](const std::vector<Vec3>& corners, const std::vector<std::array<std::uint32_t, 3>>& triangles) {
        Surface s = box(1);
        s.parts = {{"body", "", 12}, {"top", "", triangles.size()}};
        const auto first = static_cast<std::uint32_t>(s.points.size());
        s.points.insert(s.points.end(), corners.begin(), corners.end());
        for (const auto& t : triangles) {
            s.triangles.push_back({first + t[0], first + t[1], first + t[2]});
            s.partOf.push_back(1);
        }
        return fit(mesh, s).borderSamples;
    };
    // A fin, 0.5 long; the flow is inside the box, so it hangs from the top.
    EXPECT_NEAR(double(with({{0.25, 0.52, 1}, {0.75, 0.52, 1}, {0.75, 0.52, 0.6}, {0.25, 0.52, 0.6}}, {{0, 1, 2}, {0, 2, 3}})), 4 * 0.5 * n, 2);
    // A triangle through the top, 0.5 long there.
    EXPECT_NEAR(double(with({{0.25, 0.52, 1.2}, {0.75, 0.52, 1.2}, {0.75, 0.52, 0.6}, {0.25, 0.52, 0.6}}, {{0, 1, 2}, {0, 2, 3}})), 4 * 0.5 * n, 2);
}

// The box with its top, and triangles of a third part.
Surface withThird(const std::vector<Vec3>& corners, const std::vector<std::array<std::uint32_t, 3>>& triangles) {
    Surface s = boxOfTwo(1 - 1e-6);
    const auto first = static_cast<std::uint32_t>(s.points.size());
    s.points.insert(s.points.end(), corners.begin(), corners.end());
    s.parts.push_back({"third", "", triangles.size()});
    for (const auto& t : triangles) {
        s.triangles.push_back({first + t[0], first + t[1], first + t[2]});
        s.partOf.push_back(2);
    }
    return s;
}

// Of two sheets upon each other the mesh can show only one: a copy of the top asks for no patch of its own, and neither do
// its edges upon what it copies.
TEST(FitMeasure, bordersOfCopiesAreThoseOfTheOriginal) {
    const PolyMesh mesh = cubeWall([](Vec3 p) { return p; });
    const std::int64_t without = fit(mesh, boxOfTwo(1 - 1e-6)).borderSamples;
    const FitReport r = fit(mesh, withThird({{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}, {{0, 2, 1}, {0, 3, 2}}));
    EXPECT_GE(r.borderSamples, without);
    EXPECT_DOUBLE_EQ(r.partBorderFraction, 1);
    const FitReport patch = fit(mesh, withThird({{0.3, 0.3, 1}, {0.7, 0.3, 1}, {0.7, 0.7, 1}, {0.3, 0.7, 1}}, {{0, 2, 1}, {0, 3, 2}}));
    EXPECT_EQ(patch.borderSamples, without);
    EXPECT_DOUBLE_EQ(patch.partBorderFraction, 1);
}

// What stands on the far side of a sheet is not seen, though its foot lies in the sheet: the flow sees the sheet on both sides.
TEST(FitMeasure, bordersOfWhatIsHiddenAreNotAskedFor) {
    const PolyMesh mesh = cubeWall([](Vec3 p) { return p; });
    const std::int64_t without = fit(mesh, boxOfTwo(1 - 1e-6)).borderSamples;
    const auto fin = [&](double tip) {
        return fit(mesh, withThird({{0.25, 0.52, 1}, {0.75, 0.52, 1}, {0.75, 0.52, tip}, {0.25, 0.52, tip}}, {{0, 1, 2}, {0, 2, 3}})).borderSamples;
    };
    EXPECT_NEAR(double(fin(0.6) - without), 4 * 0.5 * n, 2);
    EXPECT_EQ(fin(1.4), without);
}

// A box, and a block of 0.5 x 0.5 from one height to another over its middle.
Surface boxWithBlock(double low, double high) {
    Surface s = box(1);
    const Surface block = box(1);
    const auto first = static_cast<std::uint32_t>(s.points.size());
    for (const Vec3& p : block.points) s.points.push_back({0.23 + 0.5 * p.x, 0.23 + 0.5 * p.y, low + (high - low) * p.z});
    for (const auto& t : block.triangles) s.triangles.push_back({first + t[0], first + t[1], first + t[2]}), s.partOf.push_back(0);
    return s;
}

// Edges of a block behind the wall, 0.2 h away, are none that the wall could have; those of one before it are missed.
TEST(FitMeasure, sharpEdgesThatAreHiddenAreNotAskedFor) {
    const PolyMesh mesh = cubeWall([](Vec3 p) { return p; });
    const FitReport without = fit(mesh, box(1));
    const FitReport behind = fit(mesh, boxWithBlock(1 + 0.2 * h, 1.5)), before = fit(mesh, boxWithBlock(0.5, 1 - 0.2 * h));
    EXPECT_EQ(behind.featureSamples, without.featureSamples);
    EXPECT_DOUBLE_EQ(behind.featureCaptureFraction, 1);
    EXPECT_GT(before.featureSamples, without.featureSamples + 30);
    EXPECT_LT(before.featureCaptureFraction, 0.95);
}

// What stands flush on the far side of the wall has sharp edges in it, where the wall goes straight on: they are not asked for. With
// a step of the tenth part of a cell they are.
TEST(FitMeasure, sharpEdgesWhereTheWallGoesOnAreNotAskedFor) {
    const PolyMesh mesh = cubeWall([](Vec3 p) { return p; });
    const FitReport without = fit(mesh, box(1)), flush = fit(mesh, boxWithBlock(1, 1.5)), step = fit(mesh, boxWithBlock(1 - 0.1 * h, 1.5));
    EXPECT_EQ(flush.featureSamples, without.featureSamples);
    EXPECT_DOUBLE_EQ(flush.featureCaptureFraction, 1);
    EXPECT_EQ(flush.lostEdges.total, 0);
    EXPECT_GT(step.featureSamples, without.featureSamples + 30);
    EXPECT_LT(step.featureCaptureFraction, 0.95);
}

// The edges of a block that the wall lacks are listed, not within h of its corners: as long as their samples stand for.
TEST(FitMeasure, lostEdgesAreListed) {
    const FitReport r = fit(cubeWall([](Vec3 p) { return p; }), boxWithBlock(1 - 0.1 * h, 1.5));
    ASSERT_EQ(r.lostEdges.total, 4);
    EXPECT_NEAR(r.lostEdges.length(), 4 * (0.5 - 2 * h), 4 * h / 4);
    for (const LostEdge& e : r.lostEdges.first) {
        EXPECT_NEAR(e.length, 0.5 - 2 * h, h / 4);
        EXPECT_NEAR(e.at.z, 1 - 0.1 * h, 1e-12);
        EXPECT_EQ(e.part, "box");
    }
}

// Of a block's edges that the wall lacks: those 0.3 h before the wall are left out of it, and those 0.05 h before it, up to which it does
// not fold, shallow where they run along its own edges and else crossed. Those of a box that the wall ends 0.3 h before are bridged.
TEST(FitMeasure, lostEdgesHaveACause) {
    const PolyMesh mesh = cubeWall([](Vec3 p) { return p; });
    const auto causes = [&](const Surface& s) {
        std::array<bool, lostCauses> any{};
        const FitReport r = fit(mesh, s);
        for (const LostEdge& e : r.lostEdges.first) any[static_cast<std::size_t>(e.cause)] = true;
        return any;
    };
    using Causes = std::array<bool, lostCauses>;
    EXPECT_EQ(causes(boxWithBlock(1 - 0.3 * h, 1.5)), (Causes{false, false, false, true}));
    EXPECT_EQ(causes(boxWithBlock(1 - 0.05 * h, 1.5)), (Causes{false, true, false, false})); // at 0.23 and 0.73, between edges at 0.2, 0.3 ...
    Surface onLines = boxWithBlock(1 - 0.05 * h, 1.5);
    for (std::size_t i = 8; i < onLines.points.size(); ++i)
        for (double* c : {&onLines.points[i].x, &onLines.points[i].y}) *c = std::round(*c * n) / n;
    EXPECT_EQ(causes(onLines), (Causes{true, false, false, false}));
    EXPECT_EQ(causes(box(1 + 0.3 * h)), (Causes{false, false, true, false}));
}

// Sheets end in rims, where the wall folds by 180 degrees: they are asked for like other sharp edges, and where the wall ends 0.3 h
// before one it is lost. In a crack, which something follows, there is none; nor where the graph has none marked.
TEST(FitMeasure, rimsOfSheetsAreSharpEdges) {
    Surface sheet;
    sheet.parts = {{"sheet", "", 2}};
    sheet.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
    sheet.partOf = {0, 0};
    const auto measured = [](const Surface& s, double end, bool marked) {
        const PolyMesh mesh = cubeWall([&](Vec3 p) { return Vec3{p.x * end, p.y, (p.z - 0.5) * 0.01 * h}; });
        const SurfaceIndex index(s);
        FeatureGraph features = buildFeatureGraph(s, {});
        if (marked) markRims(features, index, {});
        return measureFit(mesh, buildCellFaces(mesh), index, features, {"body", "top"});
    };
    const FitReport whole = measured(sheet, 1, true), cut = measured(sheet, 1 - 0.3 * h, true);
    EXPECT_NEAR(double(whole.featureSamples), 4 * (4 * n - 8), 8);
    EXPECT_DOUBLE_EQ(whole.featureCaptureFraction, 1);
    EXPECT_EQ(cut.lostEdges.total, 1);
    EXPECT_NEAR(cut.lostEdges.length(), 1 - 2 * h, h / 2);
    EXPECT_NEAR(cut.lostEdges.first.at(0).at.x, 1, 1e-12);
    EXPECT_EQ(measured(sheet, 1, false).featureSamples, 0);
    Surface cracked = sheet; // and goes on 0.1 h behind the end
    cracked.points.insert(cracked.points.end(), {{1 + 0.1 * h, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1 + 0.1 * h, 1, 0}});
    cracked.triangles.insert(cracked.triangles.end(), {{4, 5, 6}, {4, 6, 7}});
    cracked.partOf.insert(cracked.partOf.end(), {0, 0});
    EXPECT_NEAR(double(measured(cracked, 1, true).featureSamples), 4 * (3 * n - 4) - 4, 8);
}

// A line of many short edges is sampled like one long edge: by length, not by edge.
TEST(FitMeasure, samplesByLength) {
    Surface s = box(1);
    const auto whole = fit(cubeWall([](Vec3 p) { return p; }), s).featureSamples;
    // The two triangles at the edge y = z = 0 become fans of 200 triangles.
    const Vec3 a{0, 0, 0}, b{1, 0, 0};
    Surface fine;
    fine.parts = s.parts;
    const auto add = [&](const Vec3& p, const Vec3& q, const Vec3& r) {
        const auto k = static_cast<std::uint32_t>(fine.points.size());
        fine.points.insert(fine.points.end(), {p, q, r});
        fine.triangles.push_back({k, k + 1, k + 2});
        fine.partOf.push_back(0);
    };
    for (const auto& t : s.triangles) {
        const Vec3 v[3] = {s.points[t[0]], s.points[t[1]], s.points[t[2]]};
        int onEdge = 0;
        Vec3 apex;
        for (const Vec3& p : v) p == a || p == b ? void(++onEdge) : void(apex = p);
        if (onEdge < 2)
            add(v[0], v[1], v[2]);
        else
            for (int i = 0; i < 200; ++i) add({i / 200.0, 0, 0}, {(i + 1) / 200.0, 0, 0}, apex);
    }
    EXPECT_NEAR(double(fit(cubeWall([](Vec3 p) { return p; }), fine).featureSamples), double(whole), 3);
}

// The same report to the last bit on any number of threads.
TEST(FitMeasure, threads) {
    const PolyMesh mesh = cubeWall([](Vec3 p) {
        return p + Vec3{std::sin(9 * p.y), std::sin(8 * p.z), std::cos(7 * p.x)} * 0.02;
    });
    const Surface surface = box(1);
    const FitReport a = fit(mesh, surface);
    EXPECT_GT(a.meanDistanceInH, 0.01);
    for (const std::size_t threads : {1u, 3u, 8u}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        const FitReport b = fit(mesh, surface);
        EXPECT_EQ(a.meanDistanceInH, b.meanDistanceInH);
        EXPECT_EQ(a.maxDistanceInH, b.maxDistanceInH);
        EXPECT_EQ(a.featureCaptureFraction, b.featureCaptureFraction);
        EXPECT_EQ(a.featureSamples, b.featureSamples);
        EXPECT_EQ(a.tiltedFaceFraction, b.tiltedFaceFraction);
        EXPECT_EQ(a.farthest, b.farthest);
    }
}

} // namespace
} // namespace i2b
