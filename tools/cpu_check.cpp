// Before anything else runs, static initialisers included: has this machine the instructions that the program was built
// with? This file alone is built for any x86-64 and calls nothing of the standard library's headers.
#if defined(I2B_BUILT_FOR) && defined(__x86_64__) && defined(__GNUC__)
#include <unistd.h>

namespace {

[[gnu::constructor(101)]] void refuseMachinesWithout() {
    __builtin_cpu_init();
    if (__builtin_cpu_supports(I2B_BUILT_FOR)) return;
    constexpr char text[] = "i2b: this machine lacks instructions that the program was built with (" I2B_BUILT_FOR
                            "); configure with -DI2B_ARCH=x86-64 and build again\n";
    [[maybe_unused]] const auto written = write(2, text, sizeof text - 1);
    _exit(1);
}

} // namespace
#endif
