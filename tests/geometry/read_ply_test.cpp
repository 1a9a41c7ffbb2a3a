#include "geometry_files.h"
#include <bit>
#include <gmock/gmock.h>

namespace i2b::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

// A square of two triangles, and a quadrangle over an edge of it.
const std::array<Vec3, 6> points{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {1, 0, 0.5}, {0, 0, 0.5}}};
const std::vector<std::vector<int>> faces{{0, 1, 2}, {0, 2, 3}, {0, 1, 4, 5}};

template <class T>
void append(std::string& out, T value, bool isBig) {
    char raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);
    if (isBig) std::reverse(raw, raw + sizeof value);
    out.append(raw, sizeof value);
}

std::string binaryPly(bool isBig) {
    std::string out = fmt::format("ply\nformat binary_{}_endian 1.0\ncomment made up\nobj_info none\nelement vertex 6\nproperty short temperature\nproperty double z\nproperty float x\n"
                                  "property float32 y\nelement face 3\nproperty uchar red\nproperty list uint8 ushort vertex_index\nproperty list uchar float texcoord\nelement edge 1\nproperty int vertex1\n"
                                  "property int vertex2\nend_header\n",
                                  isBig ? "big" : "little");
    for (const Vec3& p : points) append(out, short(7), isBig), append(out, p.z, isBig), append(out, float(p.x), isBig), append(out, float(p.y), isBig);
    for (const auto& face : faces) {
        append(out, std::uint8_t(255), isBig), append(out, std::uint8_t(face.size()), isBig);
        for (const int v : face) append(out, std::uint16_t(v), isBig);
        append(out, std::uint8_t(2), isBig), append(out, 0.5f, isBig), append(out, 0.25f, isBig);
    }
    append(out, 0, isBig), append(out, 1, isBig);
    return out;
}

std::string asciiPly(const std::string& part = "") {
    std::string out = "ply\nformat ascii 1.0\n" + std::string(part.empty() ? "" : "comment part 4 front wheel\n") + "element vertex 6\nproperty float x\nproperty float y\nproperty float z\nelement face 3\n"
                      "property list uchar int vertex_indices\n" + (part.empty() ? "" : "property int part\n") + "end_header\n";
    for (const Vec3& p : points) out += fmt::format("{} {} {}\n", p.x, p.y, p.z);
    for (const auto& face : faces) out += fmt::format("{} {} {}\n", face.size(), fmt::join(face, " "), part);
    return out;
}

// Proves: text and bytes of either order, with properties and elements that mean nothing here, with any line ends, gzipped, whatever the
// name, give the same surface.
TEST(ReadPly, Encodings) {
    const TempFolder folder;
    const auto plain = read({folder.write("a.ply", asciiPly())});
    ASSERT_FALSE(plain.error) << plain.error->what();
    ASSERT_EQ(plain.surface.triangles.size(), 4u);
    EXPECT_THAT(plain.surface.triangles[3], ElementsAre(0u, 4u, 5u));
    EXPECT_EQ(plain.surface.points, std::vector<Vec3>(points.begin(), points.end()));
    EXPECT_THAT(partNames(plain.surface), ElementsAre("a"));
    std::string crlf;
    for (const char c : asciiPly()) crlf += c == '\n' ? "\r\n" : std::string(1, c);
    for (const std::string& bytes : {binaryPly(false), binaryPly(true), crlf, gzip(asciiPly()), gzip(binaryPly(true))}) {
        const auto r = read({folder.write("a.stl", bytes)});
        ASSERT_FALSE(r.error) << r.error->what();
        EXPECT_EQ(r.surface.checksum(), plain.surface.checksum());
    }
    EXPECT_EQ(read({folder.write("a.ply", asciiPly())}, 0.5).surface.points[1], (Vec3{0.5, 0, 0}));
}

// Proves: faces that say their part keep it, by the name that a comment gives it.
TEST(ReadPly, Parts) {
    const TempFolder folder;
    std::string text = asciiPly("4");
    text.replace(text.rfind('4'), 1, "9");
    const auto r = read({folder.write("car.ply", text)});
    ASSERT_FALSE(r.error) << r.error->what();
    EXPECT_THAT(partNames(r.surface), ElementsAre("front_wheel", "car"));
    EXPECT_THAT(r.surface.partOf, ElementsAre(0, 0, 1, 1));
}

// Proves: what cannot be read is refused, with what is wrong.
TEST(ReadPly, Faults) {
    const TempFolder folder;
    const auto is = [&](const std::string& text, const std::string& what) {
        const auto r = read({folder.write("a.ply", text)});
        ASSERT_TRUE(r.error) << what;
        EXPECT_EQ(r.error->kind(), ErrorKind::input);
        EXPECT_THAT(r.error->what(), HasSubstr(what));
    };
    const auto with = [](std::string text, const std::string& from, const std::string& to) { return text.replace(text.find(from), from.size(), to); };
    is("ply\nformat ascii 1.0\nelement vertex 3\n", "its header has no end");
    is(with(asciiPly(), "format ascii", "format morse"), "\"format morse 1.0\"");
    is(with(asciiPly(), "property float y", "property quad y"), "\"property quad y\"");
    is(with(asciiPly(), "property float y", "property float up"), "no x, y and z");
    is(with(asciiPly(), "vertex_indices", "corners"), "no list of points");
    is(with(asciiPly(), "element face 3", "element face 4"), "at face 4 of 4");
    is(with(asciiPly(), "element vertex 6", "element vertex 123456789123"), "at vertex 1 of 123456789123");
    is(with(asciiPly(), "3 0 1 2", "3 0 1 6"), "face 1 names point 6, and the file has 6");
    is(with(asciiPly(), "3 0 1 2", "3 0 -1 2"), "face 1 names point -1");
    is(with(asciiPly(), "element face 3", "element face 0"), "has no triangles");
    is(binaryPly(false).substr(0, binaryPly(false).size() - 30), "of 3; it may be truncated");
}

// Proves: a file cut off or damaged anywhere is read or refused, and never anything else.
TEST(ReadPly, DamagedFiles) {
    const TempFolder folder;
    for (const std::string& whole : {asciiPly("4"), binaryPly(false), binaryPly(true)}) readDamaged(folder, "damaged.ply", whole, 7, 256);
}

} // namespace
} // namespace i2b::test
