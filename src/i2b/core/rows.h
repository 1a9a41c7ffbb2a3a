// Relations turned round: of items that each belong to some rows, the items of each row. Count, scan, fill; what threads did first
// does not show, since each row is put in order at the end.
#pragma once
#include "i2b/core/parallel.h"
#include "i2b/core/raw_fill.h"
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>

namespace i2b {

// rowsOf(i, put) calls put(row) for every row of item i in [first, last), as often as it is in it; asked twice. Row r is then
// items[start[r]] .. items[start[r + 1]], in order of less(r, a, b), under which no two are alike but those of one item.
template <class Start, class RowsOf, class Less>
void turnIntoRows(std::size_t rows, std::size_t first, std::size_t last, const RowsOf& rowsOf, const Less& less, RawVector<Start>& start,
                  RawVector<std::int32_t>& items) {
    const auto raise = [](Start& n) { return std::atomic_ref<Start>(n).fetch_add(1, std::memory_order_relaxed); };
    constexpr std::size_t grain = 2048;
    RawVector<Start> next = filled(rows + 1, Start(0));
    parallelFor(last - first, [&](std::size_t i) { rowsOf(first + i, [&](std::size_t r) { raise(next[r]); }); }, grain);
    items.resize(static_cast<std::size_t>(exclusiveScan(next)));
    copyTo(start, next);
    parallelFor(last - first, [&](std::size_t i) {
        rowsOf(first + i, [&](std::size_t r) { items[static_cast<std::size_t>(raise(next[r]))] = static_cast<std::int32_t>(first + i); });
    }, grain);
    parallelFor(rows, [&](std::size_t r) { // rows are short, and nearly in order already
        std::int32_t* const v = items.data() + start[r];
        for (auto i = static_cast<std::ptrdiff_t>(start[r + 1] - start[r]), k = std::ptrdiff_t(1); k < i; ++k) {
            const std::int32_t item = v[k];
            std::ptrdiff_t at = k;
            for (; at > 0 && less(r, item, v[at - 1]); --at) v[at] = v[at - 1];
            v[at] = item;
        }
    }, grain);
}

// The same, ascending.
template <class Start, class RowsOf>
void turnIntoRows(std::size_t rows, std::size_t first, std::size_t last, const RowsOf& rowsOf, RawVector<Start>& start, RawVector<std::int32_t>& items) {
    turnIntoRows(rows, first, last, rowsOf, [](std::size_t, std::int32_t a, std::int32_t b) { return a < b; }, start, items);
}

} // namespace i2b
