#include "i2b/program/progress.h"
#include <algorithm>
#include <csignal>
#include <fmt/format.h>
#include <unistd.h>

namespace i2b {
namespace {

constexpr int barWidth = 30;
constexpr std::chrono::milliseconds redrawEvery{100};

std::atomic<Context*> interrupted{nullptr};

extern "C" void cancelOnSignal(int) {
    if (Context* const context = interrupted.load()) context->cancel();
}

void handle(void (*handler)(int), int flags) {
    struct sigaction action {};
    action.sa_handler = handler;
    action.sa_flags = flags;
    sigemptyset(&action.sa_mask);
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
}

} // namespace

ProgressStyle progressStyle(std::FILE* stream, bool quiet) {
    if (quiet) return ProgressStyle::none;
    return isatty(fileno(stream)) ? ProgressStyle::bar : ProgressStyle::lines;
}

std::string countText(std::uint64_t count) {
    if (count < 1000) return fmt::format("{}", count);
    double value = static_cast<double>(count);
    const char* unit = "";
    for (const char* next : {"k", "M", "G", "T"}) {
        // What would print as 1000.0 moves on to the next unit.
        if (value < 999.95 && *unit) break;
        value /= 1000;
        unit = next;
    }
    return fmt::format("{:.1f} {}", value, unit);
}

std::string barText(const ProgressEvent& event) {
    if (event.total == 0) return fmt::format("{:<12} {:.1f} s", event.stage, event.seconds);
    const double share =
        std::clamp(static_cast<double>(event.done) / static_cast<double>(event.total), 0.0, 1.0);
    const auto full = static_cast<std::size_t>(share * barWidth);
    std::string text = fmt::format("{:<12} [{}{}] {:>3.0f} %  {:>8}  {:.1f} s", event.stage,
                                   std::string(full, '#'), std::string(barWidth - full, '-'),
                                   std::floor(100 * share), countText(event.done), event.seconds);
    if (share > 0) text += fmt::format(", {:.1f} s left", event.seconds * (1 - share) / share);
    return text;
}

std::string lineText(const ProgressEvent& event) {
    return fmt::format("{:<12} {:>8}  {:>8.2f} s", event.stage, event.done ? countText(event.done) : "",
                       event.seconds);
}

Progress::~Progress() { clear(); }

void Progress::clear() {
    if (drawn_) fmt::print(stream_, "\r\033[K");
    drawn_ = false;
    std::fflush(stream_);
}

void Progress::draw(const ProgressEvent& event) {
    const auto now = std::chrono::steady_clock::now();
    if (drawn_ && now - last_ < redrawEvery) return;
    last_ = now;
    fmt::print(stream_, "\r\033[K{}", barText(event));
    drawn_ = true;
    std::fflush(stream_);
}

void Progress::show(const ProgressEvent& event) {
    if (style_ == ProgressStyle::none) return;
    const std::scoped_lock lock(mutex_);
    if (event.kind == ProgressEvent::Kind::end) {
        clear();
        fmt::print(stream_, "{}\n", lineText(event));
        std::fflush(stream_);
    } else if (style_ == ProgressStyle::bar)
        draw(event);
}

InterruptGuard::InterruptGuard(Context& context) {
    interrupted = &context;
    // Resetting the handler makes the second signal do what it does by default: end the process.
    handle(cancelOnSignal, static_cast<int>(SA_RESETHAND));
}

InterruptGuard::~InterruptGuard() {
    handle(SIG_DFL, 0);
    interrupted = nullptr;
}

} // namespace i2b
