#include "geometry_files.h"
#include <algorithm>
#include <gmock/gmock.h>
#include <numeric>
#include <random>
#include <tbb/global_control.h>

namespace i2b::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::string grids = "GRID    1               0.0     0.0     0.0\nGRID    2               1.      0.      0.\nGRID    3               1.0     1.0     0.\n"
                          "GRID    4               0.0     1.0     0.0\nGRID    5               0.      0.      1.0\n";

std::vector<Vec3> cornersSorted(const Surface& s) {
    std::vector<Vec3> all;
    for (std::size_t t = 0; t < s.triangles.size(); ++t)
        for (const Vec3& p : cornersOf(s, t)) all.push_back(p);
    return all;
}

// Proves: fields of 8 and 16 columns and between commas, tabs, lower case, numbers as Fortran writes them, continuation lines of all kinds,
// any line ends and gzip give the same surface.
TEST(ReadNastran, Dialects) {
    const TempFolder folder;
    const auto plain = read({folder.write("a.nas", "$ a deck\nBEGIN BULK\n" + grids + "CTRIA3  11      7       1       2       3\nCQUAD4  12      7       1       3       4       5\nENDDATA\n")});
    ASSERT_FALSE(plain.error) << plain.error->what();
    ASSERT_EQ(plain.surface.triangles.size(), 3u);
    const std::vector<Vec3> corners = cornersSorted(plain.surface);
    const std::vector<std::string> others{
        "SOL 101\nCEND\nTITLE = a deck\nBEGIN BULK\n"
        "GRID*                  1                             0.0             0.0*\n*                    0.0\n"
        "GRID*   2                               1.D0            0.+0            *A\n*A                 -0.-0\n"
        "grid*                  3                           10.-1             1.0\n*                     0.\n"
        "GRID           4              .0     1.0     0.0\nGRID           5                           +.1+1\n"
        "CTRIA3        11       7       1       2       3\nCQUAD4*               12               7               1               3*B\n*B                     4               5\n",
        "BEGIN BULK\nGRID,1,,0.0,0.0,0.0\nGRID,2,0,1.0,0.,0.\nGRID,3,,1.,1.\nGRID, 4, , 0.0 , 1.0, 0.0 $ a comment\nGRID*,5,,0.,0.\n*,1.0\nctria3,11,7,1,2,3,,,+\n+,0.5\nCQUAD4,12,7,1,3,4,5\n",
        "BEGIN BULK\nGRID\t1\t\t0.0\t0.0\t0.0\nGRID\t2\t\t1.0\t0.0\t0.0\nGRID\t3\t\t1.0\t1.0\t0.0\nGRID\t4\t\t0.0\t1.0\t0.0\nGRID\t5\t\t0.0\t0.0\t1.0\n"
        "CTRIA3\t11\t7\t1\t2\t3\nCQUAD4\t12\t7\t1\t3\t4\t5\n",
        "\xEF\xBB\xBF$ a comment\n" + grids + "CTRIA6  11      7       1       2       3       100     101     102\nCQUAD8  12      7       1       3       4       5       100     101\n+       103     104\n"};
    for (std::size_t i = 0; i < others.size(); ++i) {
        std::string crlf, cr;
        for (const char c : others[i]) crlf += c == '\n' ? "\r\n" : std::string(1, c), cr += c == '\n' ? '\r' : c;
        for (const std::string& text : {others[i], crlf, cr, gzip(others[i])}) {
            const auto r = read({folder.write("other.bdf", text)});
            ASSERT_FALSE(r.error) << i << ": " << r.error->what();
            EXPECT_EQ(cornersSorted(r.surface), corners) << i;
            EXPECT_THAT(partNames(r.surface), ElementsAre("other"));
        }
    }
}

// Proves: a part for each property in the order of their elements, with the names that pre-processors leave in comments; those of
// materials are not taken for them, and what has none is named by its number.
TEST(ReadNastran, PartsAndTheirNames) {
    const TempFolder folder;
    std::string elements;
    for (const int property : {7, 3, 7, 12, 40, 41, 9}) elements += fmt::format("CTRIA3  {:<8}{:<8}1       2       {}\n", property, property, property % 2 == 0 ? 5 : 4);
    const auto r = read({folder.write("a.nas",
                                      "$ANSA_NAME;3;PSHELL;~\n$front wheel\nPSHELL,3,1,1.0\n$ANSA_NAME;7;MAT1;~\n$steel\n$HMNAME COMP                  12\"a group\"\n"
                                      "$HMNAME PROP                  12\"rim:2\" 4\n$ Femap with NX Nastran Property 40 : tyre\n" +
                                          grids + elements + "ENDDATA\n$ANSA_NAME_COMMENT;41;PSHELL;lost;;NO;\n" )});
    ASSERT_FALSE(r.error) << r.error->what();
    EXPECT_THAT(partNames(r.surface), ElementsAre("property_7", "front_wheel", "rim_2", "tyre", "property_41", "property_9"));
    EXPECT_THAT(r.surface.partOf, ElementsAre(0, 1, 0, 2, 3, 4, 5));
    EXPECT_EQ(r.surface.parts[0].triangles, 2u);
    const auto footer = read({folder.write("b.nas", grids + "CTRIA3,1,8,1,2,3\n$ANSA_NAME_COMMENT;8;PSHELL;door;;NO;\n")});
    ASSERT_FALSE(footer.error);
    EXPECT_THAT(partNames(footer.surface), ElementsAre("door"));
}

// Proves: quadrangles are cut along the shorter diagonal, those with a corner twice are one triangle; solids and bars are left out, with a note;
// points that no shell has go, and numbers are in metres.
TEST(ReadNastran, Elements) {
    const TempFolder folder;
    const std::string kite = "GRID,1,,0.,0.,0.\nGRID,2,,4.,-1.,0.\nGRID,3,,10.,0.,0.\nGRID,4,,4.,1.,0.\nGRID,9,,50.,0.,0.\n";
    const auto r = read({folder.write("a.nas", kite + "CQUAD4,1,1,1,2,3,4\nCQUAD4,2,1,1,2,3,3\nCQUAD4,3,1,1,1,2,3\nCQUAD4,4,1,1,2,2,3\nCQUAD4,5,1,1,2,3,1\nCTETRA,6,2,1,2,3,9\nCBAR,7,3,1,9\nINCLUDE 'more.nas'\n")}, 0.1);
    ASSERT_FALSE(r.error) << r.error->what();
    ASSERT_EQ(r.surface.triangles.size(), 6u);
    EXPECT_EQ(r.surface.points.size(), 4u);
    EXPECT_EQ(cornersOf(r.surface, 0)[0], (Vec3{0.4, -0.1, 0}));
    for (std::size_t t = 2; t < 6; ++t) {
        double area = norm(cross(cornersOf(r.surface, t)[1] - cornersOf(r.surface, t)[0], cornersOf(r.surface, t)[2] - cornersOf(r.surface, t)[0])) / 2;
        EXPECT_NEAR(area, 0.05, 1e-12);
    }
    ASSERT_EQ(r.notes.messages.size(), 2u);
    EXPECT_THAT(r.notes.messages[0], HasSubstr("2 solid, bar and other elements were left out"));
    EXPECT_THAT(r.notes.messages[1], HasSubstr("1 INCLUDE"));
}

// Proves: what cannot be read is refused with the line, never taken for something else.
TEST(ReadNastran, Faults) {
    const TempFolder folder;
    const auto is = [&](const std::string& text, const std::string& what) {
        const auto r = read({folder.write("a.nas", text)});
        ASSERT_TRUE(r.error) << what;
        EXPECT_EQ(r.error->kind(), ErrorKind::input);
        EXPECT_THAT(r.error->what(), HasSubstr(what));
    };
    const std::string triangle = "CTRIA3  11      7       1       2       3\n";
    is("BEGIN BULK\nGRID,1,,0.,x,0.\n" + triangle, "a GRID has a coordinate that is no number at line 2");
    is("BEGIN BULK\nGRID,one,,0.,0.,0.\n" + triangle, "a GRID has no number at line 2");
    is("BEGIN BULK\n\nGRID,1,5,0.,0.,0.\n" + triangle, "coordinate system of its own");
    is(grids + "CTRIA3  11      7       1       2       6\n", "an element names GRID 6, which is not among the 5");
    is(grids + "CTRIA3  11      7       1       2\n", "an element has a corner without a number at line 6");
    is(grids + "CTRIA3  11      seven   1       2       3\n", "an element has no property number at line 6");
    is(grids + "GRID,5,,0.,0.,2.\n" + triangle, "GRID 5 is there twice, at different places");
    is(grids, "has no triangles");
    is("BEGIN BULK\nENDDATA\n" + grids + triangle, "has no triangles");
    EXPECT_FALSE(read({folder.write("again.nas", grids + "GRID,5,,0.,0.,1.\n" + triangle)}).error) << "the same place twice is no fault";
}

// Proves: a deck of several pieces in any order of its cards gives, on any number of threads, the surface that it was written from.
TEST(ReadNastran, LargeDecksInAnyOrder) {
    const TempFolder folder;
    constexpr int n = 160;
    const auto id = [](int i, int j) { return 1000 + 7 * (j * (n + 1) + i); };
    std::vector<std::string> cards;
    for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i) cards.push_back(fmt::format("GRID*{:>19}{:>16}{:>16}{:>16}\n*{:>23}\n", id(i, j), "", double(i) / 4, double(j) / 4, double((i * j) % 7) / 8));
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            cards.push_back(fmt::format("CTRIA3  {:>8}{:>8}{:>8}{:>8}{:>8}\n", 2 * (j * n + i) + 1, 1 + j % 3, id(i, j), id(i + 1, j), id(i + 1, j + 1)));
            cards.push_back(fmt::format("CTRIA3  {:>8}{:>8}{:>8}{:>8}{:>8}\n", 2 * (j * n + i) + 2, 1 + j % 3, id(i, j), id(i + 1, j + 1), id(i, j + 1)));
        }
    const auto text = [&] { return std::accumulate(cards.begin(), cards.end(), std::string()); };
    const auto areaOf = [](const Surface& s) {
        double area = 0;
        for (std::size_t t = 0; t < s.triangles.size(); ++t) area += norm(cross(cornersOf(s, t)[1] - cornersOf(s, t)[0], cornersOf(s, t)[2] - cornersOf(s, t)[0]));
        return area;
    };
    const auto ordered = read({folder.write("a.nas", text())});
    ASSERT_FALSE(ordered.error) << ordered.error->what();
    EXPECT_EQ(ordered.surface.triangles.size(), 2u * n * n);
    EXPECT_EQ(ordered.surface.points.size(), std::size_t(n + 1) * (n + 1));
    EXPECT_EQ(ordered.surface.parts.size(), 3u);
    std::shuffle(cards.begin(), cards.end(), std::mt19937(5));
    const std::string path = folder.write("b.nas", text());
    std::vector<std::uint64_t> sums;
    for (const std::size_t threads : {1u, 3u}) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        const auto r = read({path});
        ASSERT_FALSE(r.error) << r.error->what();
        EXPECT_EQ(r.surface.points, ordered.surface.points);
        EXPECT_NEAR(areaOf(r.surface), areaOf(ordered.surface), 1e-9 * areaOf(ordered.surface));
        sums.push_back(r.surface.checksum());
    }
    EXPECT_EQ(sums[0], sums[1]);
}

// Proves: a deck cut off or damaged anywhere is read or refused, and never anything else.
TEST(ReadNastran, DamagedDecks) {
    const TempFolder folder;
    const std::string deck = "$ANSA_NAME;7;PSHELL;~\n$skin\n" + grids + "CTRIA3  11      7       1       2       3\nCQUAD4  12      7       1       3       4       5\nENDDATA\n";
    readDamaged(folder, "damaged.nas", deck, 3, 128);
}

} // namespace
} // namespace i2b::test
