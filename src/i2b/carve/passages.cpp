#include "i2b/carve/passages.h"
#include "i2b/core/collect.h"
#include "i2b/core/parallel_sort_unique.h"
#include <algorithm>
#include <span>

namespace i2b {
namespace {

struct Step { // a cell that has been reached
    Place cell;
    double clearance = 0; // m, from its centre to the geometry
    friend bool operator<(const Step& a, const Step& b) { return a.cell < b.cell; }
};
using Steps = std::vector<Step>; // in order of cells

bool contains(const Steps& steps, const Place& c) { return std::binary_search(steps.begin(), steps.end(), Step{c, 0}); }

// Candidates beside the last step that are new.
RawVector<Place> besides(const Room& room, const Steps& last, const Steps& reached) {
    RawVector<Place> places = collect<Place>(last.size(), [&](std::size_t i, const auto& put) {
        for (int d = 0; d < 6; ++d) {
            const Place n = faceNeighbour(last[i].cell, d);
            if (room.isCandidate(n) && !room.isKept(n) && !contains(reached, n)) put(n);
        }
    }, 256);
    parallelSortUnique(places);
    return places;
}

// Those of the places that have room and a way to them from a cell that from() takes.
template <class From>
Steps reachable(const Room& room, std::span<const Place> places, const From& from) {
    Steps steps(places.size());
    parallelFor(
        places.size(),
        [&](std::size_t i) {
            steps[i] = {places[i], -1};
            double clearance = 0;
            if (!room.has(places[i], clearance)) return;
            for (int d = 0; d < 6; ++d) {
                const Place n = faceNeighbour(places[i], d);
                if (!from(n) || !room.isWay(n, places[i])) continue;
                steps[i].clearance = clearance;
                return;
            }
        },
        64);
    std::erase_if(steps, [](const Step& s) { return s.clearance < 0; });
    return steps;
}

// Of two cells with a wall between them the one that is kept stays, else the one with more room.
std::vector<Place> withoutWallsBetween(const Room& room, const Steps& given) {
    std::vector<std::uint8_t> goes(given.size(), 0);
    parallelFor(
        given.size(),
        [&](std::size_t i) {
            const Step& s = given[i];
            for (int d = 0; d < 6; ++d) {
                const Place n = faceNeighbour(s.cell, d);
                const auto other = std::lower_bound(given.begin(), given.end(), Step{n, 0});
                const bool isGiven = other != given.end() && other->cell == n;
                if ((!isGiven && !room.isKept(n)) || !room.isWallBetween(s.cell, n)) continue;
                if (!isGiven || s.clearance < other->clearance || (s.clearance == other->clearance && n < s.cell)) goes[i] = 1;
            }
        },
        64);
    std::vector<Place> cells;
    for (std::size_t i = 0; i < given.size(); ++i) {
        if (!goes[i]) cells.push_back(given[i].cell);
    }
    return cells;
}

// Both in order, and of different cells.
void append(Steps& to, const Steps& more) {
    const auto before = static_cast<std::ptrdiff_t>(to.size());
    to.insert(to.end(), more.begin(), more.end());
    std::inplace_merge(to.begin(), to.begin() + before, to.end());
}

} // namespace

std::vector<Place> passageCells(const Room& room) {
    Steps last = reachable(room, besideKept(room), [&](const Place& n) { return room.isKept(n); });
    Steps given = last;
    for (int depth = 2; depth <= passageDepth && !last.empty(); ++depth) {
        std::erase_if(last, [&](const Step& s) { return !room.leadsOn(s.cell, s.clearance); });
        Steps next = reachable(room, besides(room, last, given), [&](const Place& n) { return contains(last, n); });
        append(given, next);
        last = std::move(next);
    }
    return withoutWallsBetween(room, given);
}

} // namespace i2b
