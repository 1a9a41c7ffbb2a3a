// Small random cases for the whole road: dirty soups of every kind that the mesher promises to take.
#pragma once
#include "i2b/geometry/surface.h"
#include "i2b/options.h"
#include <string>

namespace i2b::test {

struct RandomCase {
    std::string kind;
    Surface soup;
    Options options; // without files; box, size and layers are set
};

inline constexpr unsigned caseKinds = 10;

// The case of a seed: its kind is seed % caseKinds, all else follows from a generator of that seed alone.
RandomCase randomCase(unsigned seed);
// Where the seeds of a run begin: I2B_FIRST_CASE of the environment, to hunt where no run has been; else 0.
unsigned firstRandomCase();

} // namespace i2b::test
