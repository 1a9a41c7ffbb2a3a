// Proves: leaks.ply holds each opening's faces with its place in the list, and nothing else.
#include "i2b/write/leaks_write.h"
#include "temp_folder.h"
#include <cstring>
#include <fstream>
#include <gtest/gtest.h>
#include <sstream>

namespace i2b {
namespace {

TEST(LeaksWrite, FacesCarryTheirOpening) {
    std::vector<Leak> leaks(3); // the second without faces
    leaks[0].faces = {{Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{1, 1, 0}, Vec3{0, 1, 0}}};
    leaks[2].faces = {{Vec3{5, 0, 0}, Vec3{6, 0, 0}, Vec3{6, 1, 0}, Vec3{5, 1, 0}}, {Vec3{7, 0, 0}, Vec3{8, 0, 0}, Vec3{8, 1, 0}, Vec3{7, 1, 0}}};
    const test::TempFolder folder;
    writeLeaks(leaks, folder.path() / "leaks.ply");
    std::ifstream in(folder.path() / "leaks.ply", std::ios::binary);
    std::stringstream all;
    all << in.rdbuf();
    const std::string text = all.str(), end = "end_header\n";
    EXPECT_NE(text.find("element vertex 12\n"), std::string::npos);
    EXPECT_NE(text.find("element face 3\n"), std::string::npos);
    std::size_t at = text.find(end) + end.size();
    ASSERT_EQ(text.size(), at + 12 * 24 + 3 * 21);
    const auto take = [&](auto value) {
        std::memcpy(&value, text.data() + at, sizeof value);
        at += sizeof value;
        return value;
    };
    std::vector<double> x;
    for (int i = 0; i < 36; ++i) x.push_back(take(0.0));
    EXPECT_EQ(x[3], 1);
    EXPECT_EQ(x[12], 5);
    for (const int leak : {0, 2, 2}) {
        EXPECT_EQ(take(std::uint8_t(0)), 4);
        const int first = take(0);
        for (int i = 1; i < 4; ++i) EXPECT_EQ(take(0), first + i);
        EXPECT_EQ(take(0), leak);
    }
}

} // namespace
} // namespace i2b
