// What the machine has, and what this process has taken.
#pragma once
#include <cstdint>

namespace i2b {

std::uint64_t peakResidentBytes(); // of this process so far
std::uint64_t availableBytes();    // free for new work without swapping, cgroup limits counted in

} // namespace i2b
