// A budget of wall time: what works in sweeps asks between two of them whether to go on.
#pragma once
#include <chrono>
#include <optional>

namespace i2b {

class Budget {
  public:
    Budget() = default; // without end
    explicit Budget(double seconds) { // from now on; 0: without end
        if (seconds > 0) end_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
    }
    bool isOver() const { return end_ && Clock::now() >= *end_; }

  private:
    using Clock = std::chrono::steady_clock;
    std::optional<Clock::time_point> end_;
};

} // namespace i2b
