#include "i2b/core/memory.h"
#include <algorithm>
#include <fstream>
#include <limits>
#include <malloc.h>
#include <string>
#include <sys/resource.h>
#include <unistd.h>

namespace i2b {
namespace {

std::uint64_t meminfo(const std::string& key) {
    std::ifstream in("/proc/meminfo");
    std::string name, unit;
    for (std::uint64_t value; in >> name >> value;) {
        if (name == key + ":") return value * 1024;
        std::getline(in, unit);
    }
    return 0;
}

// A missing file or "max" means no limit.
std::uint64_t number(const char* path, std::uint64_t otherwise) {
    std::ifstream in(path);
    std::uint64_t value = 0;
    return in >> value ? value : otherwise;
}

} // namespace

std::uint64_t residentBytes() {
    std::ifstream in("/proc/self/statm");
    std::uint64_t all = 0, resident = 0;
    in >> all >> resident;
    return resident * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

std::uint64_t peakResidentBytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

std::uint64_t availableBytes() {
    constexpr auto none = std::numeric_limits<std::uint64_t>::max();
    const std::uint64_t free = meminfo("MemAvailable");
    const std::uint64_t limit = number("/sys/fs/cgroup/memory.max", none);
    if (limit == none) return free;
    const std::uint64_t used = number("/sys/fs/cgroup/memory.current", 0);
    return std::min(free, limit > used ? limit - used : 0);
}

void returnFreedMemory() {
#if defined(__GLIBC__)
    malloc_trim(0);
#endif
}

} // namespace i2b
