#include "i2b/core/context.h"
#include "i2b/core/error.h"
#include "i2b/core/memory.h"

namespace i2b {

double Context::elapsed() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

void Context::checkCancelled() const {
    if (cancelled()) throw Cancelled();
}

void Context::begin(std::string stage) {
    checkCancelled();
    current_ = std::move(stage);
    start_ = std::chrono::steady_clock::now();
    if (sink_) sink_({ProgressEvent::Kind::begin, current_, 0, 0, 0});
}

void Context::advance(std::uint64_t done, std::uint64_t total) {
    if (sink_) sink_({ProgressEvent::Kind::advance, current_, done, total, elapsed()});
}

void Context::end(std::uint64_t items) {
    const double seconds = elapsed();
    stages_.push_back({current_, seconds, items, residentBytes(), peakResidentBytes()});
    if (sink_) sink_({ProgressEvent::Kind::end, current_, items, items, seconds});
}

} // namespace i2b
