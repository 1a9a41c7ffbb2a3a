#include "geometry_files.h"
#include "i2b/geometry/write_stl.h"
#include <gmock/gmock.h>
#include <sstream>

namespace i2b::test {
namespace {

using testing::ElementsAre;

std::string bytesOf(const std::string& path) {
    std::ostringstream out;
    out << std::ifstream(path, std::ios::binary).rdbuf();
    return out.str();
}

Surface twoSolids(const TempFolder& folder) {
    auto odd = tetrahedron({3.1, 1.0 / 3, 1e-7}); // no floats
    return read({folder.write("in.stl", asciiSolid("one", tetrahedron()) + asciiSolid("two", odd))}).surface;
}

// Proves: ASCII brings back every bit, every part and the order; nothing but the file is left in the folder.
TEST(WriteStl, AsciiIsReadBackExactly) {
    const TempFolder folder;
    const Surface s = twoSolids(folder);
    writeStl(s, folder.path("out.stl"), StlFormat::ascii);
    const auto back = read({folder.path("out.stl")});
    ASSERT_FALSE(back.error);
    EXPECT_EQ(back.surface.checksum(), s.checksum());
    EXPECT_TRUE(back.notes.messages.empty());
    std::size_t files = 0;
    for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder.path(""))) ++files;
    EXPECT_EQ(files, 2u);
}

// Proves: binary has one solid, the exact size, no "solid" in front, and coordinates rounded to single
// precision.
TEST(WriteStl, Binary) {
    const TempFolder folder;
    const Surface s = twoSolids(folder);
    writeStl(s, folder.path("out.stl"), StlFormat::binary);
    const std::string bytes = bytesOf(folder.path("out.stl"));
    EXPECT_EQ(bytes.size(), 84u + 50u * 8u);
    EXPECT_FALSE(bytes.starts_with("solid"));
    const auto back = read({folder.path("out.stl")});
    ASSERT_FALSE(back.error);
    EXPECT_THAT(partNames(back.surface), ElementsAre("out"));
    for (std::size_t t = 0; t < 8; ++t)
        for (std::size_t k = 0; k < 3; ++k)
            EXPECT_LT(norm(cornersOf(back.surface, t)[k] - cornersOf(s, t)[k]), 3e-7);
}

// Proves: one file a part, with the part's triangles, even where parts are mixed in the surface.
TEST(WriteStl, Folder) {
    const TempFolder folder;
    Surface s = twoSolids(folder);
    std::swap(s.triangles[0], s.triangles[7]), std::swap(s.partOf[0], s.partOf[7]);
    s.parts.push_back({"empty", "", 0});
    for (const StlFormat format : {StlFormat::ascii, StlFormat::binary}) {
        const auto paths = writeStlFolder(s, folder.path("parts/deep"), format);
        EXPECT_THAT(paths, ElementsAre(folder.path("parts/deep/one.stl"), folder.path("parts/deep/two.stl")));
        const auto back = read(paths);
        ASSERT_FALSE(back.error);
        EXPECT_THAT(partNames(back.surface), ElementsAre("one", "two"));
        EXPECT_EQ(back.surface.bounds(0), s.bounds(0));
        EXPECT_EQ(back.surface.parts[1].triangles, 4u);
    }
}

// Proves: many chunks come out in order.
TEST(WriteStl, ManyTriangles) {
    const TempFolder folder;
    const Surface s = read({folder.write("in.stl", binaryStl(sheet(128)))}).surface;
    writeStl(s, folder.path("in2.stl"), StlFormat::ascii);
    auto back = read({folder.path("in2.stl")}).surface;
    EXPECT_EQ(back.checksum(), s.checksum());
    writeStl(s, folder.path("in.stl"), StlFormat::binary);
    back = read({folder.path("in.stl")}).surface;
    EXPECT_EQ(back.checksum(), s.checksum());
}

// Proves: what cannot be written is refused, and no half of it is left.
TEST(WriteStl, Faults) {
    const TempFolder folder;
    const Surface s = twoSolids(folder);
    EXPECT_THROW(writeStl(s, folder.path("missing/out.stl"), StlFormat::ascii), Error);
    std::filesystem::create_directory(folder.path("taken.stl"));
    EXPECT_THROW(writeStl(s, folder.path("taken.stl"), StlFormat::ascii), Error);
    EXPECT_THROW(writeStlFolder(s, folder.path("in.stl"), StlFormat::ascii), Error);
    for (const auto& entry : std::filesystem::directory_iterator(folder.path("")))
        EXPECT_FALSE(contains(entry.path().string(), ".part")) << entry.path();
}

} // namespace
} // namespace i2b::test
