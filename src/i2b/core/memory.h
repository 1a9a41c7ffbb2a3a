// What the machine has, and what this process has taken.
#pragma once
#include <cstdint>

namespace i2b {

std::uint64_t residentBytes();     // of this process now
std::uint64_t peakResidentBytes(); // of this process so far
std::uint64_t availableBytes();    // free for new work without swapping, cgroup limits counted in


// Gives memory that was freed, and that the allocator keeps for later, back to the system: worth it after a stage whose
// working memory no later stage will ask for again. Costs milliseconds.
void returnFreedMemory();

} // namespace i2b
