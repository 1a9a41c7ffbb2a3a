// Proves: patches are those that the names mean, and a name that means none is an error of the command line.
#include "i2b/quality/patch_names.h"
#include "i2b/core/error.h"
#include <gtest/gtest.h>

namespace i2b {
namespace {

std::string complaint(const std::vector<Patch>& patches, const std::vector<std::string>& names) {
    try {
        patchesNamed(patches, names);
    } catch (const Error& error) {
        EXPECT_EQ(error.exitStatus(), 2);
        return error.what();
    }
    return "accepted";
}

// Patches are chosen by name or expression, of any type, once each and in the mesh's order; what means none is refused.
TEST(PatchNames, chosen) {
    const std::vector<Patch> patches{{"inlet", "patch", 0, 1}, {"wheel_1", "wall", 1, 1}, {"wheel_2", "wall", 2, 1}};
    using Names = std::vector<std::string>;
    EXPECT_EQ(patchesNamed(patches, {}), Names{});
    EXPECT_EQ(patchesNamed(patches, {"wheel_2", "inlet"}), (Names{"inlet", "wheel_2"}));
    EXPECT_EQ(patchesNamed(patches, {"wheel.*", "wheel_1"}), (Names{"wheel_1", "wheel_2"}));
    EXPECT_EQ(complaint(patches, {"wheel"}), "no patch is named 'wheel' (--patch): choose from inlet, wheel_1, wheel_2");
    EXPECT_NE(complaint(patches, {"inlet", "wheel("}).find("no regular expression"), std::string::npos);
}

} // namespace
} // namespace i2b
