// Proves: faces are cut where they are asked to be and nowhere else, with the values of the face that they come from;
// faces stay in order, the pieces of a lattice face are counted at the first of them, also when it is cut twice.
#include "carve/kept_checks.h"
#include "i2b/core/error.h"
#include "i2b/front/replace_faces.h"
#include <gtest/gtest.h>
#include <numeric>

namespace i2b::test {
namespace {

std::vector<std::int32_t> verticesOf(const Front& front, std::size_t face) {
    std::vector<std::int32_t> v;
    for (auto h : front.mesh.fv_range(FrontMesh::FaceHandle(static_cast<int>(face)))) v.push_back(h.idx());
    return v;
}

// A cyclic list from its least value on.
std::vector<std::int32_t> fromLeast(std::vector<std::int32_t> v) {
    std::rotate(v.begin(), std::min_element(v.begin(), v.end()), v.end());
    return v;
}

// A polygon along its diagonal from the first vertex on.
FaceCut halves(const Front& front, std::size_t face) {
    const std::vector<std::int32_t> v = verticesOf(front, face);
    std::vector<std::int32_t> rest(v.begin() + 2, v.end());
    rest.push_back(v[0]);
    return {static_cast<std::int32_t>(face), {{v[0], v[1], v[2]}, rest}};
}

struct Made {
    Made() : carved(3, {5, 6, 4}, 2, 1, 0.1), lattice(carved.grid, carved.kept), front(buildFront(lattice, 0.07)) {
        for (std::size_t f = 0; f < front.part.size(); ++f) front.part[f] = static_cast<std::int32_t>(f); // to tell them by
    }
    CarvedAtRandom carved;
    LatticeMesh lattice;
    Front front;
};

// Faces as their parts name them, against what was there before.
TEST(ReplaceFaces, CutsThoseAskedForAndKeepsTheOrder) {
    const Made made;
    const Front& before = made.front;
    Front front = before;
    std::vector<FaceCut> cuts;
    for (std::size_t f = 0; f < before.part.size(); f += 3) cuts.push_back(halves(before, f));
    ASSERT_GT(cuts.size(), 20u);
    replaceFaces(front, cuts);
    ASSERT_EQ(front.validate(), "");
    ASSERT_EQ(front.part.size(), before.part.size() + cuts.size());
    EXPECT_EQ(front.mesh.n_vertices(), before.mesh.n_vertices());
    for (auto v : before.mesh.vertices()) EXPECT_EQ(front.mesh.point(v), before.mesh.point(v));
    std::size_t at = 0;
    for (std::size_t f = 0; f < before.part.size(); ++f) {
        const FaceCut whole{static_cast<std::int32_t>(f), {verticesOf(before, f)}};
        const FaceCut& expected = f % 3 == 0 ? cuts[f / 3] : whole;
        for (std::size_t i = 0; i < expected.polygons.size(); ++i, ++at) {
            EXPECT_EQ(fromLeast(verticesOf(front, at)), fromLeast(expected.polygons[i]));
            EXPECT_EQ(front.part[at], before.part[f]);
            EXPECT_EQ(front.ownerCell[at], before.ownerCell[f]);
            EXPECT_EQ(front.level[at], before.level[f]);
            EXPECT_EQ(front.pieces[at], i > 0 ? 0 : expected.polygons.size());
        }
    }
    EXPECT_EQ(at, front.part.size());
}

// The first or the second half of a face that is cut already: three pieces in all, counted at the first.
TEST(ReplaceFaces, CountsPiecesOfPieces) {
    const Made made;
    Front front = made.front;
    replaceFaces(front, {halves(front, 0), halves(front, 4)});
    ASSERT_EQ(front.pieces[0], 2);
    ASSERT_EQ(front.pieces[5], 2); // face 4 of before
    // A further vertex amid the edge between the halves of face 0: both have it, the first is cut there.
    const std::vector<std::int32_t> a = verticesOf(made.front, 0);
    const auto added = static_cast<std::int32_t>(front.front.size());
    const auto p = static_cast<std::size_t>(a[0]), q = static_cast<std::size_t>(a[2]);
    front.mesh.add_vertex((front.mesh.point(FrontMesh::VertexHandle(a[0])) + front.mesh.point(FrontMesh::VertexHandle(a[2]))) * 0.5);
    front.front.push_back((front.front[p] + front.front[q]) * 0.5), front.corePoint.push_back(front.corePoints);
    front.h.push_back(front.h[p]), front.size.push_back(front.size[p]), front.inside.push_back(front.inside[p]);
    front.direction.push_back(front.direction[p]), front.outside.push_back(0);
    std::vector<std::int32_t> rest(a.begin() + 2, a.end());
    rest.insert(rest.end(), {a[0], added});
    replaceFaces(front, {{0, {{a[0], a[1], added}, {added, a[1], a[2]}}}, {1, {rest}}});
    ASSERT_EQ(front.validate(), "");
    EXPECT_EQ(front.pieces[0], 3);
    EXPECT_EQ(front.pieces[1], 0);
    EXPECT_EQ(front.pieces[2], 0);
    EXPECT_EQ(front.pieces[3], 1);
    EXPECT_EQ(front.pieces[6], 2); // as it was, one later
    for (std::size_t f = 0; f < front.pieces.size(); f += front.pieces[f]) {
        ASSERT_GT(front.pieces[f], 0);
        for (std::size_t i = 0; i < front.pieces[f]; ++i) EXPECT_EQ(front.part[f + i], front.part[f]); // one lattice face
    }
    EXPECT_EQ(std::accumulate(front.pieces.begin(), front.pieces.end(), std::size_t(0)), front.part.size());
}

// Nothing to cut leaves the very same front; cuts that do not fit together are refused.
TEST(ReplaceFaces, NothingToCutAndWrongCuts) {
    const Made made;
    Front front = made.front;
    replaceFaces(front, {});
    EXPECT_EQ(front.checksum(), made.front.checksum());
    std::vector<std::int32_t> turned = verticesOf(front, 0);
    std::reverse(turned.begin(), turned.end());
    EXPECT_THROW(replaceFaces(front, {{0, {turned}}}), Error);
}

} // namespace
} // namespace i2b::test
