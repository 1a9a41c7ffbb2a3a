#include "geometry_files.h"
#include <gmock/gmock.h>
#include <limits>
#include <tbb/global_control.h>

namespace i2b::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

// Proves: both kinds give the same triangles in file order, equal corners become one point, names follow the
// rules.
TEST(ReadStl, AsciiAndBinaryGiveTheSameSurface) {
    const TempFolder folder;
    const auto ascii = read({folder.write("a.stl", asciiSolid("tetra", tetrahedron()))});
    const auto binary = read({folder.write("tetra.stl", binaryStl(tetrahedron()))});
    for (const auto* r : {&ascii, &binary}) {
        ASSERT_FALSE(r->error);
        EXPECT_EQ(r->surface.triangles.size(), 4u);
        EXPECT_EQ(r->surface.points.size(), 4u);
        EXPECT_THAT(partNames(r->surface), ElementsAre("tetra"));
        EXPECT_EQ(cornersOf(r->surface, 3), tetrahedron()[3]);
        EXPECT_TRUE(r->notes.messages.empty());
    }
    EXPECT_EQ(ascii.surface.checksum(), binary.surface.checksum());
}

// Proves: each solid is a part; equal points of two parts stay two points; an empty solid is counted and left
// out.
TEST(ReadStl, SolidsAreParts) {
    const TempFolder folder;
    const auto r =
        read({folder.write("a.stl", asciiSolid("front wheel", tetrahedron()) + asciiSolid("nothing", {}) +
                                        asciiSolid("3rd:gear", tetrahedron()) +
                                        asciiSolid("front wheel", tetrahedron({2, 0, 0})))});
    ASSERT_FALSE(r.error);
    EXPECT_THAT(partNames(r.surface), ElementsAre("front_wheel", "part_3rd_gear", "front_wheel_2"));
    EXPECT_THAT(r.surface.partOf, ElementsAre(0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2));
    EXPECT_EQ(r.surface.points.size(), 12u);
    EXPECT_EQ(r.notes.emptyParts, 1u);
    EXPECT_EQ(r.notes.renamedParts, 3u);
}

// Proves: "solid" at the begin of a binary header does not make it text.
TEST(ReadStl, BinaryThatBeginsWithSolid) {
    const TempFolder folder;
    const auto r = read({folder.write("x.stl", binaryStl(tetrahedron(), "solid made by a binary writer"))});
    ASSERT_FALSE(r.error);
    EXPECT_EQ(r.surface.triangles.size(), 4u);
    EXPECT_THAT(partNames(r.surface), ElementsAre("x"));
}

// Proves: a wrong count is settled by the size where whole triangles follow, and said; a count beyond the
// size is refused with both numbers of bytes.
TEST(ReadStl, WrongCountInTheHeader) {
    const TempFolder folder;
    for (const std::uint32_t count : {0u, 2u, 0xFFFFFFFFu}) {
        const auto r = read({folder.write("x.stl", binaryStl(tetrahedron(), "solid b", count))});
        ASSERT_FALSE(r.error) << count << ": " << r.error->what();
        EXPECT_EQ(r.surface.triangles.size(), 4u);
        ASSERT_EQ(r.notes.messages.size(), 1u);
        EXPECT_THAT(r.notes.messages[0], HasSubstr("by its size the file has 4"));
    }
    const auto lying = read({folder.write("x.stl", binaryStl(tetrahedron(), "b", 7))});
    ASSERT_TRUE(lying.error);
    EXPECT_EQ(lying.error->kind(), ErrorKind::input);
    EXPECT_THAT(lying.error->problem(), HasSubstr("7 triangles take 434 bytes, it has 284"));
    const auto ragged = read({folder.write("x.stl", binaryStl(tetrahedron(), "b", 0) + "abc")});
    ASSERT_TRUE(ragged.error);
    EXPECT_THAT(ragged.error->problem(), HasSubstr("287 bytes"));
}

// Proves: what stands behind the triangles that the header counts is left out and said.
TEST(ReadStl, BytesBehindTheTriangles) {
    const TempFolder folder;
    const auto r = read({folder.write("x.stl", binaryStl(tetrahedron()) + "junk")});
    ASSERT_FALSE(r.error);
    EXPECT_EQ(r.surface.triangles.size(), 4u);
    ASSERT_EQ(r.notes.messages.size(), 1u);
    EXPECT_THAT(r.notes.messages[0], HasSubstr("4 bytes after its 4 triangles"));
}

// Proves: binary files in a row are parts.
TEST(ReadStl, BinarySolidsInARow) {
    const TempFolder folder;
    const auto r =
        read({folder.write("x.stl", binaryStl(tetrahedron()) + binaryStl(tetrahedron({3, 0, 0})))});
    ASSERT_FALSE(r.error);
    EXPECT_THAT(partNames(r.surface), ElementsAre("x", "x_2"));
    EXPECT_EQ(r.surface.triangles.size(), 8u);
}

// Proves: line ends, byte order mark, case, layout, comments and a missing end do not matter.
TEST(ReadStl, AsciiDialects) {
    const TempFolder folder;
    const std::string plain = asciiSolid("body", tetrahedron());
    std::string crlf, cr, oneLine, upper;
    for (const char c : plain) {
        crlf += c == '\n' ? "\r\n" : std::string(1, c);
        cr += c == '\n' ? '\r' : c;
        oneLine += c == '\n' ? ' ' : c;
        upper += static_cast<char>(std::toupper(c));
    }
    const std::uint64_t sum = read({folder.write("p.stl", plain)}).surface.checksum();
    EXPECT_EQ(read({folder.write("a.stl", crlf)}).surface.checksum(), sum);
    EXPECT_EQ(read({folder.write("a.stl", cr)}).surface.checksum(), sum);
    EXPECT_EQ(read({folder.write("a.stl", oneLine)}).surface.checksum(), sum);
    EXPECT_EQ(read({folder.write("a.stl", "\xEF\xBB\xBF" + plain)}).surface.checksum(), sum);
    EXPECT_EQ(read({folder.write("a.stl", "\n  \n" + plain + "\n\n")}).surface.checksum(), sum);
    EXPECT_EQ(read({folder.write("noextension", plain)}).surface.checksum(), sum);
    const auto shouted = read({folder.write("a.stl", upper)});
    EXPECT_THAT(partNames(shouted.surface), ElementsAre("BODY"));
    const auto noEnd = read({folder.write("a.stl", plain.substr(0, plain.find("endsolid")))});
    EXPECT_EQ(noEnd.surface.checksum(), sum);
    ASSERT_EQ(noEnd.notes.messages.size(), 1u);
    EXPECT_THAT(noEnd.notes.messages[0], HasSubstr("no end"));
}

// Proves: numbers as all kinds of programs write them.
TEST(ReadStl, Numbers) {
    const TempFolder folder;
    const auto r = read(
        {folder.write("a.stl", "solid x\nfacet normal nan nan nan\nouter loop\nvertex +1 -2.5E+0 1d1\n"
                               "vertex 1e-400 .5 5.\nvertex -0 0 1.0D-1\nendloop\nendfacet\nendsolid\n")});
    ASSERT_FALSE(r.error);
    EXPECT_EQ(cornersOf(r.surface, 0), (Corners{Vec3{1, -2.5, 10}, Vec3{0, 0.5, 5}, Vec3{0, 0, 0.1}}));
}

// Proves: triangles with NaN, infinity or absurd numbers are left out, counted, and the first is named; in
// both kinds.
TEST(ReadStl, CoordinatesThatAreNoNumbers) {
    const TempFolder folder;
    const double inf = std::numeric_limits<double>::infinity();
    auto triangles = tetrahedron();
    triangles.insert(triangles.begin() + 1, {Vec3{0, inf, 0}, Vec3{1, 0, 0}, Vec3{0, 0, 1}});
    triangles.push_back({Vec3{}, Vec3{1, 0, 0}, Vec3{0, std::numeric_limits<double>::quiet_NaN(), 1}});
    triangles.push_back({Vec3{}, Vec3{1, 0, 0}, Vec3{0, -2e30, 1}});
    const auto binary = read({folder.write("b.stl", binaryStl(triangles))});
    const auto ascii = read({folder.write("b2.stl", asciiSolid("b", triangles))});
    for (const auto* r : {&binary, &ascii}) {
        ASSERT_FALSE(r->error);
        EXPECT_EQ(r->surface.triangles.size(), 4u);
        EXPECT_EQ(r->surface.points.size(), 4u);
        EXPECT_EQ(r->notes.notNumbers, 3u);
        ASSERT_EQ(r->notes.messages.size(), 1u);
    }
    EXPECT_THAT(binary.notes.messages[0], HasSubstr("the first is triangle 2"));
    EXPECT_THAT(ascii.notes.messages[0], HasSubstr("the first at line 9"));
    const auto old = read(
        {folder.write("c.stl", asciiSolid("b", tetrahedron()) +
                                   "solid c\nfacet normal 0 0 0\nouter loop\nvertex 1.#QNAN 0 0\n"
                                   "vertex -1.#IND 0 1\nvertex 1e999 1 1\nendloop\nendfacet\nendsolid\n")});
    ASSERT_FALSE(old.error);
    EXPECT_EQ(old.notes.notNumbers, 1u);
    EXPECT_EQ(old.surface.parts.size(), 1u);
}

// Proves: a triangle without area is kept while it has extent, and left out when it is a point.
TEST(ReadStl, TrianglesWithoutArea) {
    const TempFolder folder;
    auto triangles = tetrahedron();
    triangles.push_back({Vec3{5, 5, 5}, Vec3{5, 5, 5}, Vec3{5, 5, 5}});
    triangles.push_back({Vec3{0, 0, 0}, Vec3{1, 1, 1}, Vec3{2, 2, 2}});
    triangles.push_back({Vec3{0, 0, 0}, Vec3{0, 0, 0}, Vec3{1, 0, 0}});
    const auto r = read({folder.write("b.stl", binaryStl(triangles))});
    ASSERT_FALSE(r.error);
    EXPECT_EQ(r.surface.triangles.size(), 6u);
    EXPECT_EQ(r.notes.coincident, 1u);
    EXPECT_EQ(r.notes.zeroArea, 2u);
    EXPECT_EQ(r.notes.messages.size(), 2u);
}

// Proves: -0 and 0 are one place; neighbours one bit apart are not.
TEST(ReadStl, OnlyEqualPointsAreWelded) {
    const TempFolder folder;
    const double next = double(std::nextafter(1.0f, 2.0f));
    const auto r =
        read({folder.write("b.stl", binaryStl({{Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}},
                                               {Vec3{-0.0, -0.0, 0}, Vec3{0, 1, -0.0}, Vec3{next, 0, 0}}}))});
    ASSERT_FALSE(r.error);
    EXPECT_EQ(r.surface.points.size(), 4u);
}

// Proves: gzip is told by its bytes: any name, several members in one file.
TEST(ReadStl, Gzip) {
    const TempFolder folder;
    const std::string ascii = asciiSolid("body", tetrahedron()), binary = binaryStl(tetrahedron());
    const std::uint64_t sum = read({folder.write("p.stl", ascii)}).surface.checksum();
    EXPECT_EQ(read({folder.write("p.stl.gz", gzip(ascii))}).surface.checksum(), sum);
    EXPECT_EQ(read({folder.write("lies.stl", gzip(ascii))}).surface.checksum(), sum);
    EXPECT_EQ(read({folder.write("plain.gz", ascii)}).surface.checksum(), sum);
    EXPECT_EQ(read({folder.write("two.gz", gzip(ascii.substr(0, 100)) + gzip(ascii.substr(100)))})
                  .surface.checksum(),
              sum);
    EXPECT_EQ(read({folder.write("body.stl.gz", gzip(binary))}).surface.checksum(), sum);
}

// Proves: the scale is applied to every coordinate.
TEST(ReadStl, Scale) {
    const TempFolder folder;
    const auto r = read({folder.write("b.stl", binaryStl(tetrahedron({1000, 0, 0})))}, 0.001);
    ASSERT_FALSE(r.error);
    EXPECT_DOUBLE_EQ(r.surface.bounds().lo.x, 1);
    EXPECT_DOUBLE_EQ(r.surface.bounds().hi.x, 1.001);
}

// Proves: files that take several pieces are welded over the pieces' borders into as many points as the sheet
// has, in file order, and are the same on 1, 2, 3 and 8 threads; solids that span pieces keep their
// triangles.
TEST(ReadStl, ManyPiecesAnyNumberOfThreads) {
    const TempFolder folder;
    const int n = 128;
    const auto triangles = sheet(n);
    const std::vector<Corners> half(triangles.begin(), triangles.begin() + n * n),
        rest(triangles.begin() + n * n, triangles.end());
    const std::string binary = folder.write("b.stl", binaryStl(triangles));
    const std::string ascii = folder.write("a.stl", asciiSolid("b", triangles));
    const std::string parts =
        folder.write("p.stl", asciiSolid("one", half) + asciiSolid("two", {}) + asciiSolid("three", rest));
    ASSERT_GT(std::filesystem::file_size(ascii), std::size_t{2} << 21);
    std::vector<std::uint64_t> binarySums, asciiSums, partSums;
    for (const std::size_t threads : {1u, 2u, 3u, 8u}) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        const auto b = read({binary}), a = read({ascii}), p = read({parts});
        ASSERT_EQ(b.surface.points.size(), std::size_t((n + 1) * (n + 1)));
        for (std::size_t t = 0; t < triangles.size(); t += 501)
            ASSERT_EQ(cornersOf(b.surface, t), triangles[t]);
        ASSERT_EQ(p.surface.parts.size(), 2u);
        EXPECT_EQ(p.surface.parts[0].triangles, half.size());
        EXPECT_EQ(p.surface.parts[1].name, "three");
        EXPECT_EQ(p.surface.points.size(), std::size_t((n + 1) * (n + 2)));
        binarySums.push_back(b.surface.checksum());
        asciiSums.push_back(a.surface.checksum());
        partSums.push_back(p.surface.checksum());
    }
    EXPECT_THAT(asciiSums, testing::Each(binarySums[0]));
    EXPECT_THAT(binarySums, testing::Each(binarySums[0]));
    EXPECT_THAT(partSums, testing::Each(partSums[0]));
}

} // namespace
} // namespace i2b::test
