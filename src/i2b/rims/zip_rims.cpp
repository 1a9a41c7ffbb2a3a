#include "i2b/rims/zip_rims.h"
#include "i2b/core/parallel.h"
#include "i2b/edit/shape_zip.h"
#include <algorithm>
#include <limits>
#include <map>
#include <unordered_map>

namespace i2b {
namespace {

using Index = std::size_t;
constexpr int shapings = 20; // rounds in which columns are moved
constexpr Index sample = 16;  // zips side by side: where of so many
constexpr Index oneIn = 20;   // fewer than one in so many can be shaped, as under very thin layers, none of the others is tried

class Zipper {
  public:
    Zipper(ZipStar& star, std::vector<Zip> zips, std::int32_t cells, const DictionaryLimits& limits)
        : star_(star), limits_(limits), zips_(std::move(zips)), before_(zips_.size()), isWorse_(zips_.size(), 0), isChanged_(Index(cells), true) {}
    std::int64_t run();

  private:
    void judgeChanged();
    bool isNoWorse(Index i) const { return star_.isSound(zips_[i]) && star_.isNoWorse(zips_[i], before_[i], limits_); }
    bool shapeWorse(bool isFirst);
    using Cells = std::vector<std::int32_t>;
    void shape(const std::vector<Index>& turn, const std::vector<Cells>& around);
    double excessOf(Index i) const;
    std::vector<std::uint8_t> worstOfWorse() const;
    bool open(const std::vector<std::uint8_t>& opens);
    void markChanged(const Cells& cells) {
        for (const std::int32_t c : cells) isChanged_[Index(c)] = true;
    }

    ZipStar& star_;
    const DictionaryLimits& limits_;
    std::vector<Zip> zips_;
    std::vector<Verdict> before_;         // per zip
    std::vector<std::uint8_t> isWorse_;   // per zip
    std::vector<bool> isChanged_;         // per cell: since zips there were judged
    std::map<std::int32_t, Vec3> places_; // m, of points of columns that were moved
};

// Of zips whose cells have changed since.
void Zipper::judgeChanged() {
    parallelFor(zips_.size(), [&](Index i) {
        if (std::ranges::none_of(zips_[i].star, [&](std::int32_t c) { return isChanged_[Index(c)]; })) return;
        isWorse_[i] = !isNoWorse(i);
    }, 1);
    isChanged_.assign(isChanged_.size(), false);
}

// Zips that share no cell, side by side. around: the cells of each zip and those beside them.
void Zipper::shape(const std::vector<Index>& turn, const std::vector<Cells>& around) {
    std::vector<std::vector<std::pair<std::int32_t, Vec3>>> places(turn.size());
    parallelFor(turn.size(), [&](Index k) { places[k] = shapeZip(star_, zips_[turn[k]], limits_); }, 1);
    for (Index k = 0; k < turn.size(); ++k) {
        if (places[k].empty()) continue;
        for (const auto& [point, place] : places[k]) places_[point] = place, star_.apply({point, -1, place});
        markChanged(around[turn[k]]);
    }
}

// All in turns, in their order; whether there is hope for others, which the first turn of all tells.
bool Zipper::shapeWorse(bool isFirst) {
    std::vector<std::uint8_t> isSound(zips_.size(), 0);
    std::vector<Cells> around(zips_.size());
    parallelFor(zips_.size(), [&](Index i) {
        isSound[i] = isWorse_[i] && star_.isSound(zips_[i]);
        if (isSound[i]) around[i] = star_.withNeighbours(zips_[i].star);
    }, 1);
    std::vector<Index> left;
    for (Index i = 0; i < zips_.size(); ++i)
        if (isSound[i]) left.push_back(i);
    while (!left.empty()) {
        std::vector<Index> turn, later;
        std::vector<bool> isTaken(isChanged_.size());
        for (const Index i : left) {
            if (std::ranges::any_of(around[i], [&](std::int32_t c) { return isTaken[Index(c)]; })) {
                later.push_back(i);
                continue;
            }
            for (const std::int32_t c : around[i]) isTaken[Index(c)] = true;
            turn.push_back(i);
        }
        shape(turn, around);
        if (isFirst && turn.size() >= sample) {
            parallelFor(turn.size(), [&](Index k) { isWorse_[turn[k]] = !isNoWorse(turn[k]); }, 1);
            const auto good = static_cast<Index>(std::ranges::count_if(turn, [&](Index i) { return !isWorse_[i]; }));
            if (good * oneIn < turn.size()) return false;
        }
        isFirst = false;
        left = std::move(later);
    }
    return true;
}

// How much worse a zip leaves its cells.
double Zipper::excessOf(Index i) const {
    if (!star_.isSound(zips_[i])) return std::numeric_limits<double>::infinity();
    const Verdict now = star_.now(zips_[i], limits_);
    double excess = 0;
    for (Index k = 0; k < now.counts.size(); ++k) excess += static_cast<double>(std::max<std::int64_t>(0, now.counts[k] - before_[i].counts[k]));
    return excess;
}

// Of worse zips that share cells those that are worst by most: what is worse about others may be theirs.
std::vector<std::uint8_t> Zipper::worstOfWorse() const {
    std::vector<double> excess(zips_.size(), -1);
    parallelFor(zips_.size(), [&](Index i) {
        if (isWorse_[i]) excess[i] = excessOf(i);
    }, 1);
    std::unordered_map<std::int32_t, Index> worst; // per cell
    for (Index i = 0; i < zips_.size(); ++i) {
        if (!isWorse_[i]) continue;
        for (const std::int32_t c : zips_[i].star)
            if (const auto [at, isNew] = worst.try_emplace(c, i); !isNew && excess[i] > excess[at->second]) at->second = i;
    }
    std::vector<std::uint8_t> found(zips_.size(), 0);
    for (Index i = 0; i < zips_.size(); ++i)
        found[i] = isWorse_[i] && std::ranges::all_of(zips_[i].star, [&](std::int32_t c) { return worst.at(c) == i; });
    return found;
}

bool Zipper::open(const std::vector<std::uint8_t>& opens) {
    Index kept = 0;
    std::map<std::int32_t, Vec3> places;
    for (Index i = 0; i < zips_.size(); ++i) {
        if (opens[i]) {
            markChanged(star_.withNeighbours(zips_[i].star));
            continue;
        }
        if (kept < i) zips_[kept] = std::move(zips_[i]), before_[kept] = before_[i], isWorse_[kept] = isWorse_[i];
        for (const Zip::Column& column : zips_[kept].columns)
            for (const std::int32_t p : column.points)
                if (const auto at = places_.find(p); at != places_.end()) places.insert(*at);
        ++kept;
    }
    if (kept == zips_.size()) return false;
    zips_.resize(kept), before_.resize(kept), isWorse_.resize(kept);
    places_ = std::move(places); // of none that only those opened had
    star_.use(zips_, places_);
    return true;
}

std::int64_t Zipper::run() {
    if (zips_.empty()) return 0;
    parallelFor(zips_.size(), [&](Index i) { before_[i] = star_.before(zips_[i], limits_); }, 1);
    star_.use(zips_, places_);
    int round = 0;
    do {
        judgeChanged();
        if (round++ >= shapings) continue;
        if (!shapeWorse(round == 1)) {
            open(std::vector(isWorse_));
            round = shapings;
        }
        judgeChanged();
    } while (open(worstOfWorse()));
    return static_cast<std::int64_t>(zips_.size());
}

} // namespace

std::int64_t zipRims(ZipStar& star, const PolyMesh& mesh, const Rows& cellFaces, const Wall& wall, const Front& front, const SurfaceIndex& index, const FeatureIndex& rims,
                     const DictionaryLimits& limits, std::int32_t firstLayerCell) {
    return Zipper(star, findRimZips(mesh, cellFaces, star, wall, front, index, rims, firstLayerCell), mesh.cells, limits).run();
}

} // namespace i2b
