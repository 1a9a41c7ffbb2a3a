// Shows a run on the terminal: a bar per stage that is redrawn in place, or plain lines where nobody watches.
#pragma once
#include "i2b/core/context.h"
#include <chrono>
#include <cstdio>
#include <mutex>
#include <string>

namespace i2b {

enum class ProgressStyle { none, lines, bar };

// none if quiet, bar on a terminal, else lines.
ProgressStyle progressStyle(std::FILE* stream, bool quiet);

class Progress {
  public:
    Progress(std::FILE* stream, ProgressStyle style) : stream_(stream), style_(style) {}
    ~Progress(); // leaves no half-drawn bar behind
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    void show(const ProgressEvent& event); // from any thread

  private:
    void draw(const ProgressEvent& event);
    void clear();
    std::FILE* stream_;
    ProgressStyle style_;
    std::mutex mutex_;
    bool drawn_ = false;
    std::chrono::steady_clock::time_point last_{};
};

// "950", "12.3 k", "14.5 M", "1.2 G".
std::string countText(std::uint64_t count);
// "cut  [#####-----]  50 %  14.5 M  2.0 s, 2.0 s left"; without a total, no bar and no rest.
std::string barText(const ProgressEvent& event);
// "cut  14.5 M  4.0 s"
std::string lineText(const ProgressEvent& event);

// While it lives, the first Ctrl-C (or termination) cancels the context, the second ends the process. One at
// a time.
class InterruptGuard {
  public:
    explicit InterruptGuard(Context& context);
    ~InterruptGuard();
    InterruptGuard(const InterruptGuard&) = delete;
    InterruptGuard& operator=(const InterruptGuard&) = delete;
};

} // namespace i2b
