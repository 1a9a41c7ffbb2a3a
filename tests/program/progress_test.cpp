#include "i2b/program/progress.h"
#include <csignal>
#include <cstdlib>
#include <gmock/gmock.h>

namespace i2b {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using Kind = ProgressEvent::Kind;

std::string shown(ProgressStyle style, const std::vector<ProgressEvent>& events) {
    char* text = nullptr;
    std::size_t size = 0;
    std::FILE* const stream = open_memstream(&text, &size);
    {
        Progress progress(stream, style);
        for (const ProgressEvent& event : events) progress.show(event);
    }
    std::fclose(stream);
    std::string result(text, size);
    std::free(text);
    return result;
}

// Counts stay four digits wide at every unit's edge.
TEST(Progress, CountsAreShort) {
    EXPECT_EQ(countText(0), "0");
    EXPECT_EQ(countText(999), "999");
    EXPECT_EQ(countText(1000), "1.0 k");
    EXPECT_EQ(countText(999'949), "999.9 k");
    EXPECT_EQ(countText(999'950), "1.0 M");
    EXPECT_EQ(countText(14'540'000), "14.5 M");
    EXPECT_EQ(countText(1'200'000'000), "1.2 G");
    EXPECT_EQ(countText(~0ull), "18446744.1 T");
}

// Time left is what is left at the speed so far; more done than expected stays at 100 %.
TEST(Progress, BarShowsShareAndTimeLeft) {
    const std::string quarter = barText({Kind::advance, "cut", 25, 100, 2});
    EXPECT_THAT(quarter, HasSubstr("25 %"));
    EXPECT_THAT(quarter, HasSubstr("2.0 s, 6.0 s left"));
    EXPECT_THAT(barText({Kind::advance, "cut", 300, 100, 2}), HasSubstr("100 %"));
    EXPECT_THAT(barText({Kind::advance, "cut", 5, 0, 2}), Not(HasSubstr("%")));
}

// Where nobody watches: one line at the end of a stage and no control characters; quiet: nothing at all.
TEST(Progress, PlainLinesAndSilence) {
    const std::vector<ProgressEvent> run{
        {Kind::begin, "cut", 0, 0, 0}, {Kind::advance, "cut", 5, 10, 1}, {Kind::end, "cut", 10, 10, 2}};
    const std::string lines = shown(ProgressStyle::lines, run);
    EXPECT_EQ(std::ranges::count(lines, '\n'), 1);
    EXPECT_THAT(lines, Not(HasSubstr("\033")));
    EXPECT_THAT(lines, HasSubstr("2.00 s"));
    EXPECT_EQ(shown(ProgressStyle::none, run), "");
}

// A bar that a cancelled run leaves behind is wiped, so that the message after it starts on a clean line.
TEST(Progress, UnfinishedBarIsWiped) {
    const std::string bar = shown(ProgressStyle::bar, {{Kind::advance, "cut", 5, 10, 1}});
    EXPECT_THAT(bar, HasSubstr("50 %"));
    EXPECT_THAT(bar, ::testing::EndsWith("\r\033[K"));
}

// Ctrl-C asks the run to stop; a second one is no longer caught; after the run nothing is caught.
TEST(Interrupt, CancelsOnceThenKills) {
    Context context;
    {
        const InterruptGuard guard(context);
        EXPECT_FALSE(context.cancelled());
        std::raise(SIGINT);
        EXPECT_TRUE(context.cancelled());
        EXPECT_EXIT(std::raise(SIGINT), ::testing::KilledBySignal(SIGINT), "");
    }
    EXPECT_EXIT(std::raise(SIGTERM), ::testing::KilledBySignal(SIGTERM), "");
}

} // namespace
} // namespace i2b
