#include "i2b/program/limits_in_reach.h"
#include "i2b/quality/dictionary_measure.h"
#include <algorithm>
#include <array>
#include <fmt/format.h>

namespace i2b {
namespace {

// Of the wall's faces, for it is there that cells are not cubes: where faces beyond a limit are fewer nearly all of them can be
// mended, where they are more nearly none,
constexpr double mostPoor = 0.3;
constexpr double fewPoor = 500; // faces: nor does it take long to try for so few

struct Limit {
    const char* option;
    double DictionaryLimits::*value;
    bool isMost; // else least
};

// In the order of DictionaryLimit.
constexpr std::array<Limit, dictionaryLimitCount> all{{
    {"max-non-orthogonality", &DictionaryLimits::nonOrthogonality, true},
    {"min-pyramid-volume", &DictionaryLimits::pyramidVolume, false},
    {"min-tet-quality", &DictionaryLimits::tetQuality, false},
    {"max-concavity", &DictionaryLimits::concavity, true},
    {"min-face-area", &DictionaryLimits::faceArea, false},
    {"max-internal-skewness", &DictionaryLimits::internalSkewness, true},
    {"max-boundary-skewness", &DictionaryLimits::boundarySkewness, true},
    {"min-face-weight", &DictionaryLimits::faceWeight, false},
    {"min-volume-ratio", &DictionaryLimits::volumeRatio, false},
    {"min-twist", &DictionaryLimits::twist, false},
    {"min-triangle-twist", &DictionaryLimits::triangleTwist, false},
    {"min-flatness", &DictionaryLimits::flatness, false},
    {"min-determinant", &DictionaryLimits::determinant, false},
}};

bool isStricter(const Limit& limit, const DictionaryLimits& asked, const DictionaryLimits& fallback) {
    const double a = asked.*limit.value, b = fallback.*limit.value;
    return limit.isMost ? a < b : a > b;
}

} // namespace

LimitsInReach limitsInReach(const PolyMesh& mesh, const DictionaryLimits& asked, const DictionaryLimits& fallback) {
    LimitsInReach reach{asked, {}};
    if (std::ranges::none_of(all, [&](const Limit& l) { return isStricter(l, asked, fallback); })) return reach;
    const std::vector<DictionaryCheck> checks = measureQuality(mesh, {}, asked).dictionary;
    std::int64_t walls = 0;
    for (const Patch& patch : mesh.patches) walls += patch.type == "wall" ? patch.count : 0;
    const double most = std::max(fewPoor, mostPoor * static_cast<double>(walls));
    for (std::size_t k = 0; k < all.size(); ++k) {
        const Limit& limit = all[k];
        if (!isStricter(limit, asked, fallback) || !checks[k].asked || static_cast<double>(checks[k].faces) <= most) continue;
        const double instead = fallback.*limit.value;
        reach.limits.*limit.value = instead;
        reach.givenUp.push_back(fmt::format("{0} {1:g} is out of reach, as {2} faces are beyond it from the start: {3}, and what is beyond {1:g} is counted only",
                                            limit.option, asked.*limit.value, checks[k].faces,
                                            limit.isMost || instead > -1 ? fmt::format("the mesh is held to {:g}", instead) : "the mesh is held to none"));
    }
    return reach;
}

} // namespace i2b
