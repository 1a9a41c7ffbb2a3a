#include "geometry_files.h"
#include <gmock/gmock.h>
#include <tbb/global_control.h>

namespace i2b::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::string points = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\n";

// Proves: all forms of a corner name the point that comes first; normals and texture are not looked at.
TEST(ReadObj, CornerForms) {
    const TempFolder folder;
    const auto r = read({folder.write("a.obj", points + "vt 0 0\nvn 0 0 1\nf 1 2 3\nf 1/1 2/1 3/1\nf 1//1 "
                                                        "2//1 3//1\nf 1/1/1 2/1/1 3/1/1\nf -5 -4 -3\n")});
    ASSERT_FALSE(r.error) << r.error->what();
    EXPECT_THAT(r.surface.triangles, testing::Each(ElementsAre(0u, 1u, 2u)));
    EXPECT_EQ(r.surface.triangles.size(), 5u);
    EXPECT_EQ(r.surface.points.size(), 3u) << "unused points go";
    EXPECT_THAT(partNames(r.surface), ElementsAre("a"));
}

// Proves: polygons become fans, in order; lines segments; points free points; usemtl and the rest change
// nothing.
TEST(ReadObj, Statements) {
    const TempFolder folder;
    const auto r =
        read({folder.write("a.obj", "# comment\nmtllib x.mtl\n" + points +
                                        "usemtl red\ng quad\ns off\nf 1 2 3 4 # a square\nusemtl blue\n"
                                        "f 1 2 5\ng wire\nl 1 5 3\np 2 -1\n")});
    ASSERT_FALSE(r.error) << r.error->what();
    EXPECT_THAT(r.surface.triangles,
                ElementsAre(ElementsAre(0u, 1u, 2u), ElementsAre(0u, 2u, 3u), ElementsAre(0u, 1u, 4u)));
    EXPECT_THAT(partNames(r.surface), ElementsAre("quad", "wire"));
    EXPECT_EQ(r.surface.parts[0].triangles, 3u);
    ASSERT_EQ(r.surface.segments.size(), 2u);
    EXPECT_EQ(r.surface.segments[1].a, 4u);
    EXPECT_EQ(r.surface.segments[1].b, 2u);
    EXPECT_EQ(r.surface.segments[1].part, 1);
    EXPECT_THAT(r.surface.freePoints, ElementsAre(1u, 4u));
}

// Proves: a group taken up again goes on; an object's group of a name that others have too gets the object's
// name.
TEST(ReadObj, GroupsAndObjects) {
    const TempFolder folder;
    const auto again = read({folder.write("a.obj", points + "g a\nf 1 2 3\ng b\nf 1 3 4\ng a\nf 1 2 5\n")});
    ASSERT_FALSE(again.error);
    EXPECT_THAT(partNames(again.surface), ElementsAre("a", "b"));
    EXPECT_THAT(again.surface.partOf, ElementsAre(0, 1, 0));
    EXPECT_EQ(again.surface.parts[0].triangles, 2u);
    const auto objects =
        read({folder.write("a.obj", points + "o car\ng rim\nf 1 2 3\ng tyre\nf 1 3 4\no bus\ng rim\nf 1 2 "
                                             "5\no road\nf 2 3 5\ng default\nf 2 3 5\n")});
    ASSERT_FALSE(objects.error);
    EXPECT_THAT(partNames(objects.surface), ElementsAre("car_rim", "tyre", "bus_rim", "road", "road_2"));
    const auto alone = read({folder.write("alone.obj", points + "o default\nf 1 2 3\n")});
    EXPECT_THAT(partNames(alone.surface), ElementsAre("alone"));
}

// Proves: CRLF, CR, a byte order mark, tabs and backslashes at line ends give the same surface.
TEST(ReadObj, Dialects) {
    const TempFolder folder;
    const std::string plain = points + "g x\nf 1 2 3 4\nf 1 2 5\n";
    std::string crlf, cr;
    for (const char c : plain) crlf += c == '\n' ? "\r\n" : std::string(1, c), cr += c == '\n' ? '\r' : c;
    const std::uint64_t sum = read({folder.write("a.obj", plain)}).surface.checksum();
    EXPECT_EQ(read({folder.write("b.obj", crlf)}).surface.checksum(), sum);
    EXPECT_EQ(read({folder.write("c.obj", cr)}).surface.checksum(), sum);
    EXPECT_EQ(read({folder.write("d.obj", "\xEF\xBB\xBF" + plain)}).surface.checksum(), sum);
    EXPECT_EQ(read({folder.write("e.obj.gz", gzip(plain))}).surface.checksum(), sum);
    EXPECT_EQ(read({folder.write("nameless", plain)}).surface.checksum(), sum);
    EXPECT_EQ(
        read({folder.write("f.obj", "v 0 0\\\n 0\nv\\\r\n1 0 0\nv\t1 1\t0 1.0\nv 0 1 0 0.5 0.5 0.5\nv 0 0 1\n"
                                    "g x\nf 1 \\\n2 3\\\n 4\nf 1 2\\\r\n5")})
            .surface.checksum(),
        sum);
}

// Proves: a compressed file may be of several members, padded, whose last one's trailer says little of the whole, and pack better than
// room is made for at first.
TEST(ReadObj, CompressedMembers) {
    const TempFolder folder;
    const std::string blank(1 << 20, '\n'), first = points + blank, last = "g x\nf 1 2 3 4\nf 1 2 5\n";
    const std::uint64_t sum = read({folder.write("a.obj", first + last)}).surface.checksum();
    EXPECT_EQ(read({folder.write("b.obj.gz", gzip(first) + gzip(last))}).surface.checksum(), sum);
    EXPECT_EQ(read({folder.write("c.obj.gz", gzip(points) + gzip(last) + std::string(512, '\0'))}).surface.checksum(), read({folder.write("d.obj", points + last)}).surface.checksum());
    EXPECT_EQ(read({folder.write("e.obj.gz", gzip(first + last))}).surface.checksum(), sum);
}

// Proves: triangles with no numbers go with their points, points of triangles too; faces may come before
// their points.
TEST(ReadObj, TrianglesThatCannotBeUsed) {
    const TempFolder folder;
    const auto r = read({folder.write(
        "a.obj", "f 1 2 3\n" + points +
                     "v nan 0 0\nv 1 0 0\nf 1 2 6\nf 2 7 2\nf 1 2 4\nf 1 2\nl 1 6\np 6\nf 1 2 7\n")});
    ASSERT_FALSE(r.error) << r.error->what();
    EXPECT_EQ(r.surface.triangles.size(), 3u);
    EXPECT_EQ(r.notes.notNumbers, 1u);
    EXPECT_EQ(r.notes.coincident, 1u) << "2 and 7 are one place";
    EXPECT_EQ(r.notes.zeroArea, 1u);
    EXPECT_TRUE(r.surface.segments.empty());
    EXPECT_TRUE(r.surface.freePoints.empty());
    EXPECT_EQ(r.surface.points.size(), 5u);
    ASSERT_GE(r.notes.messages.size(), 2u);
    EXPECT_THAT(r.notes.messages[0], HasSubstr("the first is triangle 2"));
    EXPECT_THAT(r.notes.messages[1], HasSubstr("less than three corners"));
}

// Proves: a corner without a point is refused, whichever way it counts; so is what is no number, with its
// line.
TEST(ReadObj, Faults) {
    const TempFolder folder;
    const auto problem = [&](const std::string& text) {
        const auto r = read({folder.write("a.obj", text)});
        return r.error ? r.error->problem() : "none";
    };
    EXPECT_THAT(problem(points + "f 1 2 6\n"), HasSubstr("names point 6, and the file has 5"));
    EXPECT_THAT(problem(points + "f 1 2 -6\n"), HasSubstr("names point 0"));
    EXPECT_THAT(problem(points + "f 1 2 -9223372036854775808\n"), HasSubstr("no point number at line 6"));
    EXPECT_THAT(problem(points + "f 1 2 99999999999999999999\n"), HasSubstr("no point number at line 6"));
    EXPECT_THAT(problem(points + "f 1 0 2\n"), HasSubstr("no point number at line 6"));
    EXPECT_THAT(problem(points + "f 1 2 x\n"), HasSubstr("no point number at line 6"));
    EXPECT_THAT(problem("v 0 0 0\nv 1 zero 0\nf 1 1 1\n"), HasSubstr("no number at line 2"));
    EXPECT_THAT(problem("v 0 0 0\nv 1 0\nv 1 1 1\nf 1 2 3\n"), HasSubstr("no number at line 2"));
    EXPECT_THAT(problem(points), HasSubstr("no triangles"));
    EXPECT_THAT(problem(points + "l 1 2\n"), HasSubstr("no triangles"));
    EXPECT_THAT(problem("# only words\n"), HasSubstr("no statement"));
}

// Proves: a file of several pieces, with relative corners and groups across their borders, reads as the same
// file with absolute ones does, on any number of threads.
TEST(ReadObj, ManyPiecesAnyNumberOfThreads) {
    const TempFolder folder;
    const auto triangles = sheet(128);
    std::string relative, absolute;
    std::size_t n = 0;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        std::string v;
        for (const Vec3& p : triangles[t]) v += fmt::format("v {:.9f} {:.9f} {:.9f}\n", p.x, p.y, p.z);
        if (t % 20000 == 10000) v += fmt::format("g part{}\n", t / 20000);
        n += 3;
        relative += v + "f -3 -2 -1\n";
        absolute += v + fmt::format("f {} {} {}\n", n - 2, n - 1, n);
    }
    ASSERT_GT(relative.size(), std::size_t{2} << 20);
    const std::string a = folder.write("a.obj", absolute), b = folder.write("b.obj", relative);
    std::vector<std::uint64_t> sums;
    for (const std::size_t threads : {1u, 2u, 3u, 8u}) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        const auto x = read({a}), y = read({b});
        ASSERT_FALSE(x.error || y.error);
        ASSERT_EQ(x.surface.triangles.size(), triangles.size());
        EXPECT_THAT(partNames(y.surface), ElementsAre("b", "part0", "part1"));
        EXPECT_EQ(x.surface.triangles, y.surface.triangles);
        EXPECT_EQ(x.surface.partOf, y.surface.partOf);
        EXPECT_EQ(cornersOf(y.surface, 32000), triangles[32000]);
        sums.push_back(y.surface.checksum());
    }
    EXPECT_THAT(sums, testing::Each(sums[0]));
}

} // namespace
} // namespace i2b::test
