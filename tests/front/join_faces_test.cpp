// Proves: polygons joined at once give the very mesh that OpenMesh makes of them one by one, closed or open, in any order of faces;
// polygons that are not manifold are refused with the place.
#include "i2b/core/error.h"
#include "i2b/front/join_faces.h"
#include <algorithm>
#include <array>
#include <gtest/gtest.h>
#include <random>

namespace i2b::test {
namespace {

using Faces = std::vector<std::vector<std::int32_t>>;

FrontMesh::Point placeOf(std::size_t v) { return {double(v), double(v * v % 17), 1}; }

Polygons polygonsOf(const Faces& faces) {
    Polygons p;
    for (const auto& face : faces) {
        p.vertices.insert(p.vertices.end(), face.begin(), face.end());
        p.start.push_back(p.vertices.size());
    }
    return p;
}

FrontMesh oneByOne(std::size_t vertices, const Faces& faces) {
    FrontMesh mesh;
    for (std::size_t v = 0; v < vertices; ++v) mesh.add_vertex(placeOf(v));
    for (const auto& face : faces) {
        std::vector<FrontMesh::VertexHandle> polygon;
        for (const std::int32_t v : face) polygon.emplace_back(v);
        EXPECT_TRUE(mesh.add_face(polygon).is_valid());
    }
    return mesh;
}

void expectSame(const FrontMesh& a, const FrontMesh& b) {
    ASSERT_EQ(a.n_vertices(), b.n_vertices());
    ASSERT_EQ(a.n_edges(), b.n_edges());
    ASSERT_EQ(a.n_faces(), b.n_faces());
    for (auto v : a.vertices()) {
        EXPECT_EQ(a.point(v), b.point(v));
        EXPECT_EQ(a.halfedge_handle(v), b.halfedge_handle(v)) << v.idx();
    }
    for (auto f : a.faces()) EXPECT_EQ(a.halfedge_handle(f), b.halfedge_handle(f)) << f.idx();
    for (auto h : a.halfedges()) {
        EXPECT_EQ(a.to_vertex_handle(h), b.to_vertex_handle(h));
        EXPECT_EQ(a.face_handle(h), b.face_handle(h));
        EXPECT_EQ(a.next_halfedge_handle(h), b.next_halfedge_handle(h)) << h.idx();
        EXPECT_EQ(a.prev_halfedge_handle(h), b.prev_halfedge_handle(h)) << h.idx();
    }
}

// A grid of quads, closed to a torus or open, some of them cut, in a random order.
Faces randomFaces(int nx, int ny, bool closed, unsigned seed) {
    std::mt19937 random(seed);
    const int px = closed ? nx : nx + 1, py = closed ? ny : ny + 1;
    Faces faces;
    for (int x = 0; x < nx; ++x) {
        for (int y = 0; y < ny; ++y) {
            const auto at = [&](int i, int j) { return ((x + i) % px) * py + (y + j) % py; };
            std::array<std::int32_t, 4> q{at(0, 0), at(1, 0), at(1, 1), at(0, 1)};
            std::rotate(q.begin(), q.begin() + random() % 4, q.end());
            if (random() % 3) faces.push_back({q.begin(), q.end()});
            else faces.push_back({q[0], q[1], q[2]}), faces.push_back({q[0], q[2], q[3]});
        }
    }
    std::shuffle(faces.begin(), faces.end(), random);
    return faces;
}

TEST(JoinFaces, AreThoseOfOpenMesh) {
    for (unsigned seed = 0; seed < 40; ++seed) {
        SCOPED_TRACE(seed);
        const int nx = 3 + int(seed) % 7, ny = seed == 0 ? 1500 : 3 + int(seed) % 5;
        const bool closed = seed % 2 == 0;
        const Faces faces = randomFaces(nx, ny, closed, seed);
        const auto n = static_cast<std::size_t>(closed ? nx * ny : (nx + 1) * (ny + 1));
        expectSame(oneByOne(n, faces), joinFaces(n, placeOf, polygonsOf(faces), "faces"));
    }
}

TEST(JoinFaces, MayBeNone) {
    EXPECT_EQ(joinFaces(3, placeOf, {}, "faces").n_vertices(), 3u);
    EXPECT_EQ(joinFaces(0, placeOf, {}, "faces").n_vertices(), 0u);
}

// Two open fans at a vertex: OpenMesh decides how they follow each other.
TEST(JoinFaces, OfTwoFansAtAVertexAreThoseOfOpenMesh) {
    const Faces faces{{0, 1, 2}, {0, 3, 4}};
    expectSame(oneByOne(5, faces), joinFaces(5, placeOf, polygonsOf(faces), "faces"));
}

TEST(JoinFaces, ThatAreNotManifoldAreRefused) {
    const Faces threeAtAnEdge{{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}, twoSided{{0, 1}};
    Faces twoFans = randomFaces(3, 3, true, 1); // and a second closed surface at vertex 0
    for (const auto& face : randomFaces(3, 3, true, 2)) {
        twoFans.push_back(face);
        for (std::int32_t& v : twoFans.back()) v = v == 0 ? 0 : v + 8;
    }
    for (const auto& [n, faces] : {std::pair{5u, threeAtAnEdge}, std::pair{2u, twoSided}, std::pair{17u, twoFans}}) {
        try {
            joinFaces(n, placeOf, polygonsOf(faces), "these faces");
            ADD_FAILURE() << "no refusal";
        } catch (const Error& e) {
            EXPECT_NE(std::string(e.what()).find("these faces"), std::string::npos) << e.what();
        }
    }
}

} // namespace
} // namespace i2b::test
