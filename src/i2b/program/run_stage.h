// Runs one stage of the program under its name.
#pragma once
#include "i2b/core/context.h"
#include "i2b/core/memory.h"
#include <cstdint>

namespace i2b {

// body() gives the product; count(product) is the number of items that the stage reports.
template <class Body, class Count>
auto stage(Context& context, const char* name, const Body& body, const Count& count) {
    Stage timed(context, name);
    auto result = body();
    timed.items = static_cast<std::uint64_t>(count(result));
    returnFreedMemory();
    return result;
}

} // namespace i2b
