#include "geometry_files.h"
#include <gmock/gmock.h>
#include <random>

namespace i2b::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::string smallObj =
    "o box\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nvn 0 0 1\ng side\nf 1//1 2//1 3//1 4//1\n"
    "g top\nf -1 \\\n -2 -3\nl 1 5\np 2\n";

std::string faultOf(const std::string& path, double scale = 1) {
    const auto r = read({path}, scale);
    return r.error ? r.error->what() : "none";
}

// Proves: each way in which a file cannot be read is told by one sentence that names the file.
TEST(ReadFaults, OneSentenceEach) {
    const TempFolder folder;
    const auto is = [&](const std::string& path, const std::string& words) {
        const auto r = read({path});
        ASSERT_TRUE(r.error) << path;
        EXPECT_EQ(r.error->kind(), ErrorKind::input);
        EXPECT_EQ(r.error->where(), path);
        EXPECT_THAT(r.error->problem(), HasSubstr(words));
        EXPECT_FALSE(r.error->remedy().empty());
        EXPECT_FALSE(contains(r.error->what(), "\n"));
    };
    is(folder.path("missing.stl"), "does not exist");
    is(folder.path(""), "is a folder");
    is(folder.write("empty.stl", ""), "is empty");
    is("/dev/null", "not a regular file");
    is(folder.write("text.stl", "This is no geometry at all.\n"), "neither STL, OBJ, PLY nor Nastran");
    is(folder.write("picture.png", std::string("\x89PNG\r\n\x1a\n\0\0\0\rIHDR", 16) + std::string(500, '\7')),
       "neither STL, OBJ, PLY nor Nastran");
    is(folder.write("none.stl", "solid none\nendsolid none\n"), "no triangles");
    is(folder.write("none2.stl", binaryStl({}, std::string("b\0", 2))), "no triangles");
    is(folder.write("point.stl", binaryStl({Corners{}})), "no usable triangles, 1 were left out");
    is(folder.write("short.stl", std::string("b\0\0\0", 4)), "truncated: a header takes 84 bytes, it has 4");
    is(folder.write("open.stl", "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0"),
       "truncated inside the facet that begins at line 2");
    is(folder.write(
           "two.stl",
           "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\nendfacet\n"),
       "2 corners at line 2");
    is(folder.write("word.stl", "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 O 0\n"),
       "no number at line 4");
    const std::string gz = gzip(asciiSolid("x", tetrahedron()));
    is(folder.write("cut.stl.gz", gz.substr(0, gz.size() / 2)), "compressed file is truncated");
    std::string bad = gz;
    bad[bad.size() - 6] = static_cast<char>(bad[bad.size() - 6] ^ 1);
    is(folder.write("bad.stl.gz", bad), "damaged");
    is(folder.write("hollow.gz", gzip("")), "holds nothing");
}

// Proves: a file that may not be read says so.
TEST(ReadFaults, Permission) {
    if (::geteuid() == 0) GTEST_SKIP() << "root may read everything";
    const TempFolder folder;
    const std::string path = folder.write("a.stl", asciiSolid("x", tetrahedron()));
    std::filesystem::permissions(path, std::filesystem::perms::none);
    EXPECT_THAT(faultOf(path), HasSubstr("may not be read"));
}

// Proves: calls that are wrong in themselves are faults of usage.
TEST(ReadFaults, Usage) {
    const TempFolder folder;
    const std::string path = folder.write("a.stl", asciiSolid("x", tetrahedron()));
    for (const double scale : {0.0, -1.0, std::nan("")})
        EXPECT_EQ(read({path}, scale).error->kind(), ErrorKind::usage);
    EXPECT_EQ(read({}).error->kind(), ErrorKind::usage);
}

// Proves: of several bad files the first in the list is named, whichever is found first.
TEST(ReadFaults, FirstOfSeveral) {
    const TempFolder folder;
    const std::string good = folder.write("a.stl", asciiSolid("x", tetrahedron()));
    for (int i = 0; i < 20; ++i) {
        const auto r = read({good, folder.path("one.stl"), folder.path("two.stl"), folder.path("three.stl")});
        ASSERT_TRUE(r.error);
        EXPECT_EQ(r.error->where(), folder.path("one.stl"));
    }
}

// Proves: several files are joined in order, their names made unique over all of them.
TEST(ReadFiles, AreJoined) {
    const TempFolder folder;
    const auto r = read({folder.write("a.stl", asciiSolid("body", tetrahedron())),
                         folder.write("b.obj", "g body\n" + smallObj.substr(6)),
                         folder.write("c.stl", binaryStl(tetrahedron()))});
    ASSERT_FALSE(r.error) << r.error->what();
    EXPECT_THAT(partNames(r.surface), ElementsAre("body", "side", "top", "c"));
    EXPECT_EQ(r.surface.triangles.size(), 4u + 3u + 4u);
    EXPECT_EQ(r.surface.points.size(), 4u + 5u + 4u);
    EXPECT_THAT(r.surface.freePoints, ElementsAre(5u));
    EXPECT_EQ(r.surface.segments[0].part, 2);
    EXPECT_EQ(cornersOf(r.surface, 10), tetrahedron()[3]);
    const auto twice = read({folder.path("a.stl"), folder.path("a.stl")});
    EXPECT_THAT(partNames(twice.surface), ElementsAre("body", "body_2"));
}

struct Sample {
    std::string name, bytes;
};

std::vector<Sample> samples() {
    const std::string ascii = asciiSolid("a", tetrahedron()) + asciiSolid("b", tetrahedron({2, 0, 0}));
    return {{"x.stl", binaryStl(tetrahedron())},
            {"solid.stl", binaryStl(tetrahedron(), "solid binary")},
            {"a.stl", ascii},
            {"o.obj", smallObj},
            {"a.stl.gz", gzip(ascii)},
            {"x.stl.gz", gzip(binaryStl(tetrahedron()))}};
}

// Every outcome is a valid surface (read() checks) or an input error that names the file.
void expectSane(const ReadResult& r, const std::string& path, const std::string& what) {
    if (!r.error) return;
    EXPECT_EQ(r.error->kind(), ErrorKind::input) << what;
    EXPECT_EQ(r.error->where(), path) << what;
    EXPECT_FALSE(r.error->problem().empty()) << what;
}

// Proves: a file cut off after any byte is read or refused, never worse; a binary or compressed one is always
// refused.
TEST(ReadFaults, TruncatedAtEveryByte) {
    const TempFolder folder;
    for (const Sample& s : samples())
        for (std::size_t n = 0; n < s.bytes.size(); ++n) {
            const std::string path = folder.write(s.name, s.bytes.substr(0, n));
            const auto r = read({path});
            expectSane(r, path, fmt::format("{} cut at {}", s.name, n));
            if (s.name == "x.stl" || s.name == "solid.stl" || s.name.ends_with(".gz")) {
                EXPECT_TRUE(r.error) << s.name << " cut at " << n;
            }
            if (s.name == "x.stl" && n > 84) {
                EXPECT_THAT(r.error->problem(), HasSubstr(fmt::format("take 284 bytes, it has {}", n)));
            }
        }
}

// Proves: bytes changed at random (fixed seed) lead to a valid surface or a clear refusal.
TEST(ReadFaults, ChangedBytes) {
    const TempFolder folder;
    std::mt19937 random(7);
    for (const Sample& s : samples())
        for (int round = 0; round < 1500; ++round) {
            std::string bytes = s.bytes;
            for (int k = 0; k <= round % 3; ++k) {
                const std::size_t at = random() % bytes.size();
                static constexpr char tempting[] = "\0\n\r\\ -/.#f9\xff";
                bytes[at] =
                    round % 2 ? static_cast<char>(random()) : tempting[random() % (sizeof tempting - 1)];
            }
            const std::string path = folder.write(s.name, bytes);
            expectSane(read({path}), path, fmt::format("{} round {}", s.name, round));
        }
}

} // namespace
} // namespace i2b::test
