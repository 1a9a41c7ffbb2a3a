#include "i2b/quality/patch_names.h"
#include "i2b/core/error.h"
#include "i2b/geometry/part_names.h"
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace i2b {
namespace {

NamePattern patternOf(const std::string& name) {
    try {
        return NamePattern(name);
    } catch (const std::regex_error&) {
        throw Error(ErrorKind::usage, fmt::format("'{}' is no regular expression", name), "--patch",
                    "write the patch's whole name, or an expression such as wheel.*");
    }
}

[[noreturn]] void refuse(const std::string& name, const std::vector<Patch>& patches) {
    std::vector<std::string> all;
    for (const Patch& patch : patches) all.push_back(patch.name);
    throw Error(ErrorKind::usage, fmt::format("no patch is named '{}'", name), "--patch",
                fmt::format("choose from {}", fmt::join(all, ", ")));
}

} // namespace

std::vector<std::string> patchesNamed(const std::vector<Patch>& patches, const std::vector<std::string>& names) {
    std::vector<bool> chosen(patches.size());
    for (const std::string& name : names) {
        const NamePattern pattern = patternOf(name);
        bool found = false;
        for (std::size_t i = 0; i < patches.size(); ++i)
            if (pattern.matches(patches[i].name)) chosen[i] = found = true;
        if (!found) refuse(name, patches);
    }
    std::vector<std::string> result;
    for (std::size_t i = 0; i < patches.size(); ++i)
        if (chosen[i]) result.push_back(patches[i].name);
    return result;
}

} // namespace i2b
