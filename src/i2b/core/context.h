// Progress, cancellation and timing of a run travel together in one object that the caller owns. Stages only
// tell it what they do; they never print. All members may be called from any thread.
#pragma once
#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace i2b {

struct StageRecord {
    std::string name;
    double seconds = 0;
    std::uint64_t items = 0; // what the stage counts: triangles, cells, faces
    std::uint64_t rssBytes = 0, peakRssBytes = 0; // of the process: resident at the stage's end, and the most so far
};

struct ProgressEvent {
    enum class Kind { begin, advance, end } kind;
    std::string stage;
    std::uint64_t done = 0, total = 0; // total 0: not known
    double seconds = 0;                // since the stage began
};

class Context {
  public:
    using Sink = std::function<void(const ProgressEvent&)>;

    Context() = default;
    explicit Context(Sink sink) : sink_(std::move(sink)) {}
    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;

    // May be called from a signal handler.
    void cancel() { cancelled_.store(true, std::memory_order_relaxed); }
    bool cancelled() const { return cancelled_.load(std::memory_order_relaxed); }
    void checkCancelled() const; // throws Cancelled

    // begin/end are called by one thread, in pairs (see Stage); advance by any.
    void begin(std::string stage);
    void advance(std::uint64_t done, std::uint64_t total);
    void end(std::uint64_t items);
    const std::vector<StageRecord>& stages() const { return stages_; }

  private:
    double elapsed() const;
    Sink sink_;
    std::atomic<bool> cancelled_{false};
    std::string current_;
    std::chrono::steady_clock::time_point start_{};
    std::vector<StageRecord> stages_;
};

// Times a stage for as long as it lives.
class Stage {
  public:
    Stage(Context& context, std::string name) : context_(context) { context_.begin(std::move(name)); }
    ~Stage() { context_.end(items); }
    Stage(const Stage&) = delete;
    Stage& operator=(const Stage&) = delete;
    std::uint64_t items = 0;

  private:
    Context& context_;
};

} // namespace i2b
