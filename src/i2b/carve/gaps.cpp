#include "i2b/carve/gaps.h"
#include "i2b/carve/min_cut.h"
#include "i2b/core/parallel.h"
#include "i2b/core/sort_unique.h"
#include <algorithm>
#include <cmath>
#include <tuple>

namespace i2b {
namespace {

constexpr long face = 1000; // price: those of the cut are whole numbers
constexpr long tie = 50;    // what is as good filled as not is filled

// A removed cell that has been looked at. Where its centre lies in no gap it is closed on all sides.
struct GapCell {
    Place cell;
    double clearance = 0;      // of h
    std::uint8_t open = 0;     // bit a direction: a neighbour there would have a face into the gap, if it is given back
    bool isCovered = false;    // but not if it is kept
    std::uint8_t walled = 0;   // bit a direction: a wall stands between the two centres
    bool fits = false;         // may be given back
    Displaced displaced{};     // kept cells that go then
    friend bool operator<(const GapCell& a, const GapCell& b) { return a.cell < b.cell; }
};

bool has(std::uint8_t bits, int direction) { return (bits >> direction & 1) != 0; }

class GapFiller {
  public:
    GapFiller(const Room& room, const GapOptions& options) : room_(room), options_(options) {}
    GapFilling run();

  private:
    GapCell look(const Place& c) const;
    std::vector<Place> look(const std::vector<Place>& places);
    void partWalled();
    const GapCell* find(const Place& c) const {
        const auto at = std::lower_bound(cells_.begin(), cells_.end(), GapCell{c});
        return at != cells_.end() && at->cell == c ? &*at : nullptr;
    }
    // Would a kept cell in this direction from a removed one have a face into a gap?
    bool isOpen(const Place& removed, int direction) const {
        const GapCell* cell = find(removed);
        return cell && has(cell->open, direction);
    }
    GapFilling cut() const;

    const Room& room_;
    const GapOptions options_;
    std::vector<GapCell> cells_; // in order
};

GapCell GapFiller::look(const Place& c) const {
    GapCell cell{c};
    const WallsAround walls = room_.wallsAround(c);
    cell.clearance = walls.clearance;
    if (!walls.isOpposite) return cell;
    cell.isCovered = room_.isKeptAt(c, walls.toWall * -options_.across);
    cell.fits = walls.clearance >= room_.options().least && walls.width >= options_.width;
    for (int d = 0; d < 6; ++d) {
        const Place n = faceNeighbour(c, d);
        if (room_.isWallBetween(c, n)) {
            cell.walled |= std::uint8_t(1 << d);
            cell.fits = cell.fits && (!room_.isKept(n) || room_.displace(n, cell.displaced));
            continue;
        }
        // However narrow the crack that leads there: paint decides which regions are meshed.
        cell.fits = cell.fits && !room_.isForeign(n);
        const double away = walls.toWall[d >> 1] * (d & 1 ? -1 : 1); // of the wall from that neighbour
        if (away < options_.ahead) cell.open |= std::uint8_t(1 << d);
    }
    cell.fits = cell.fits && room_.isFree(c);
    return cell;
}

// Gives the places to look at next: beside cells that may be given back.
std::vector<Place> GapFiller::look(const std::vector<Place>& places) {
    std::vector<GapCell> looked(places.size());
    parallelFor(places.size(), [&](std::size_t i) { looked[i] = look(places[i]); }, 32);
    const std::size_t before = cells_.size();
    cells_.insert(cells_.end(), looked.begin(), looked.end());
    std::inplace_merge(cells_.begin(), cells_.begin() + std::ptrdiff_t(before), cells_.end());
    std::vector<Place> next;
    for (const GapCell& cell : looked) {
        for (int d = 0; cell.fits && d < 6; ++d) {
            const Place n = faceNeighbour(cell.cell, d);
            if (!has(cell.walled, d) && room_.isCandidate(n) && !room_.isKept(n) && !find(n)) next.push_back(n);
        }
    }
    sortUnique(next);
    return next;
}

// Of two cells with a wall between them one may be given back: the one that displaces fewer, or has more room.
void GapFiller::partWalled() {
    const auto rank = [](const GapCell& cell) { return std::tuple(cell.displaced.size(), -cell.clearance, cell.cell); };
    std::vector<std::uint8_t> goes(cells_.size(), 0);
    parallelFor(cells_.size(), [&](std::size_t i) {
        const GapCell& cell = cells_[i];
        for (int d = 0; cell.fits && d < 6; ++d) {
            const GapCell* other = has(cell.walled, d) ? find(faceNeighbour(cell.cell, d)) : nullptr;
            if (other && other->fits && rank(*other) < rank(cell)) goes[i] = 1;
        }
    });
    for (std::size_t i = 0; i < cells_.size(); ++i) cells_[i].fits = cells_[i].fits && !goes[i];
}

GapFilling GapFiller::cut() const {
    std::vector<const GapCell*> items;
    for (const GapCell& cell : cells_) {
        if (cell.fits) items.push_back(&cell);
    }
    const auto itemOf = [&](const Place& c) { // items.size() for one that is none
        const auto at = std::lower_bound(items.begin(), items.end(), c, [](const GapCell* a, const Place& b) { return a->cell < b; });
        return at != items.end() && (*at)->cell == c ? std::size_t(at - items.begin()) : items.size();
    };
    const long displacing = std::lround(options_.displaced * double(face));
    MinCut cut(items.size());
    for (std::size_t i = 0; i < items.size(); ++i) {
        const GapCell& cell = *items[i];
        cut.addTaken(i, displacing * long(cell.displaced.size()));
        if (!cell.isCovered) cut.addLeft(i, tie);
        for (int d = 0; d < 6; ++d) {
            const Place n = faceNeighbour(cell.cell, d);
            const long into = isOpen(n, d ^ 1) ? face : 0, from = has(cell.open, d) ? face : 0;
            if (const std::size_t other = itemOf(n); other < items.size()) {
                if (other > i) cut.addPair(i, other, into, from);
            } else if (room_.isKept(n)) {
                if (!cell.isCovered) cut.addLeft(i, from);
            } else {
                cut.addTaken(i, into);
            }
        }
    }
    const std::vector<unsigned char> taken = cut.solve();
    GapFilling filling;
    for (std::size_t i = 0; i < items.size(); ++i) {
        if (!taken[i]) continue;
        filling.given.push_back(items[i]->cell);
        filling.displaced.insert(filling.displaced.end(), items[i]->displaced.begin(), items[i]->displaced.end());
    }
    sortUnique(filling.displaced);
    return filling;
}

GapFilling GapFiller::run() {
    std::vector<Place> places = besideKept(room_);
    for (int step = 0; step < options_.depth && !places.empty(); ++step) places = look(places);
    partWalled();
    return cut();
}

} // namespace

GapFilling fillGaps(const Room& room, const GapOptions& options) { return GapFiller(room, options).run(); }

} // namespace i2b
