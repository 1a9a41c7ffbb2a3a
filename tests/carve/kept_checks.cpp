#include "carve/kept_checks.h"
#include "i2b/carve/carve.h"
#include "i2b/carve/gaps.h"
#include "i2b/carve/vertex_patterns.h"
#include "i2b/grid/cut.h"
#include "i2b/sizing/size_field.h"
#include <fmt/format.h>

namespace i2b::test {
namespace {

// Vertices of the finest lattice with the eight cells around each.
class Vertices {
  public:
    Vertices(const CellGrid& grid, const KeptCells& kept)
        : array_(grid), kept_(array_.flagged(kept.levels)) {}
    const CellArray& array() const { return array_; }
    bool isKept(int cell) const { return cell >= 0 && kept_[static_cast<std::size_t>(cell)]; }
    int around(const Index3& v, int o) const {
        return array_.at({v[0] - 1 + (o & 1), v[1] - 1 + (o >> 1 & 1), v[2] - 1 + (o >> 2)});
    }
    int outside(const Index3& v) const {
        int bits = 0;
        for (std::size_t a = 0; a < 3; ++a) {
            bits |= (v[a] == 0 ? 1 : 0) << (2 * a) | (v[a] == array_.size[a] ? 2 : 0) << (2 * a);
        }
        return bits;
    }
    // Finest level of a cell that has v as a corner, or of a cell around where edges cross; -1: no vertex.
    int level(const Index3& v) const {
        int best = -1, any = -1;
        std::array<bool, 3> meet{};
        for (int o = 0; o < 8; ++o) {
            const int c = around(v, o);
            for (std::size_t a = 0; a < 3; ++a) meet[a] = meet[a] || c != around(v, o ^ 1 << a);
            if (c < 0) continue;
            const Index3 s = array_.span(c);
            const int finest = array_.cells[static_cast<std::size_t>(c)].triple.finest();
            any = std::max(any, finest);
            if (v[0] % s[0] == 0 && v[1] % s[1] == 0 && v[2] % s[2] == 0) best = std::max(best, finest);
        }
        return best >= 0 || !(meet[0] && meet[1] && meet[2]) ? best : any;
    }
    const VertexPattern& pattern(const Index3& v) const {
        int bits = 0;
        for (int o = 0; o < 8; ++o) bits |= int(isKept(around(v, o))) << o;
        return vertexPattern(mirrored(static_cast<std::uint8_t>(bits), outside(v)));
    }
    template <class F>
    void forEach(const F& f) const {
        for (int x = 0; x <= array_.size[0]; ++x) {
            for (int y = 0; y <= array_.size[1]; ++y) {
                for (int z = 0; z <= array_.size[2]; ++z) {
                    if (level({x, y, z}) >= 0) f(Index3{x, y, z});
                }
            }
        }
    }

  private:
    CellArray array_;
    std::vector<bool> kept_;
};

} // namespace

std::string frontFault(const CellGrid& grid, const KeptCells& kept) {
    const Vertices vertices(grid, kept);
    std::string fault;
    vertices.forEach([&](const Index3& v) {
        if (!fault.empty()) return;
        const VertexPattern& p = vertices.pattern(v);
        if (!p.allGood) fault = fmt::format("vertex {} {} {}: a fan without direction", v[0], v[1], v[2]);
        for (std::size_t e = 0; e < 6; ++e) {
            if (p.edge[e] == Alternation::none || vertices.outside(v) >> e & 1) continue;
            Index3 end = v;
            do end[e / 2] += e % 2 ? 1 : -1;
            while (vertices.level(end) < 0);
            if (vertices.pattern(end).edge[e ^ 1] != p.edge[e]) {
                fault =
                    fmt::format("edge {} of vertex {} {} {} comes apart in two ways", e, v[0], v[1], v[2]);
            }
        }
    });
    if (!fault.empty()) return fault;
    std::vector<std::vector<Mask::Ptr>> zones = kept.zones;
    if (zones.empty()) zones.push_back(kept.levels);
    for (const std::vector<Mask::Ptr>& zone : zones) {
        const std::vector<int> label = vertices.array().flood(vertices.array().flagged(zone));
        const int pieces = *std::max_element(label.begin(), label.end()) + 1;
        if (pieces != 1) return fmt::format("{} pieces", pieces);
    }
    return "";
}

std::string voidInFlow(const CellGrid& grid, const CutCells& cut, const Regions& regions, const KeptCells& kept) {
    const CellArray array(grid);
    const std::vector<bool> isKept = array.flagged(kept.levels);
    std::vector<bool> hasCause = array.flagged(cut.levels); // the geometry, or flow that is not to be meshed
    for (const Region& region : regions.table) {
        if (region.painted) continue;
        const std::vector<bool> other = array.flagged(regions.cellsOf(region.id));
        for (std::size_t c = 0; c < other.size(); ++c) hasCause[c] = hasCause[c] || other[c];
    }
    std::vector<bool> isMissing(isKept.size());
    for (std::size_t c = 0; c < isKept.size(); ++c) isMissing[c] = !isKept[c];
    const std::vector<int> label = array.flood(isMissing);
    std::vector<bool> isCaused(label.size());
    for (std::size_t c = 0; c < label.size(); ++c)
        if (label[c] >= 0 && hasCause[c]) isCaused[static_cast<std::size_t>(label[c])] = true;
    for (std::size_t c = 0; c < label.size(); ++c)
        if (label[c] >= 0 && !isCaused[static_cast<std::size_t>(label[c])]) return fmt::format("cell {} of the array, and {} missing beside it", c, std::ranges::count(label, label[c]) - 1);
    return "";
}

double leastClearance(const CellGrid& grid, const KeptCells& kept, const SurfaceIndex& index) {
    const Vertices vertices(grid, kept);
    double least = std::numeric_limits<double>::infinity();
    vertices.forEach([&](const Index3& v) {
        bool touches = false;
        for (int o = 0; o < 8; ++o) touches = touches || vertices.isKept(vertices.around(v, o));
        if (!touches) return;
        const double d = index.closest(grid.lattice.corner(grid.lattice.maxLevel, v)).distance;
        least = std::min(least, d / grid.lattice.h(vertices.level(v)));
    });
    return least;
}

Painted::Painted(const RandomCase& c) : soup(c.soup), index(std::make_unique<SurfaceIndex>(soup)) {
    field = makeSizeField(soup, c.options.size, c.options.domain);
    const std::vector<CellLevel> target = cutAtTargetLevels(soup, field);
    grid = buildCellGrid(field, wantedCells(field, target));
    cut = cutLeafCells(soup, field, grid, target);
    regions = labelRegions(grid, cut);
    chooseRegions(regions, grid, *index, c.options.domain);
}

CarvedAtRandom::CarvedAtRandom(unsigned seed, const Index3& count, int levels, int buffer, double closed, bool perAxis) {
    far.points = {{1e3, 1e3, 1e3}, {1e3, 1001, 1e3}, {1e3, 1e3, 1001}};
    far.triangles = {{0, 1, 2}};
    far.partOf = {0};
    far.parts = {{"far", "", 1}};
    index = std::make_unique<SurfaceIndex>(far);
    grid = randomGrid(seed, count, levels, buffer, perAxis);
    const CutCells cut = randomCut(grid, seed + 1000, closed);
    regions = labelRegions(grid, cut);
    const auto largest =
        std::max_element(regions.table.begin(), regions.table.end(),
                         [](const Region& a, const Region& b) { return a.volume < b.volume; });
    largest->painted = true;
    FitOptions options;
    options.passages = false; // the walls are not the geometry's, so nothing tells where there is room
    kept = carve(grid, cut, regions, *index, options);
}

std::string wallBetweenKept(const CellGrid& grid, const CutCells& cut, const KeptCells& kept, const SurfaceIndex& index) {
    for (std::size_t l = 0; l < grid.levels.size(); ++l) {
        const LevelTriple level = grid.levels[l].level;
        for (auto it = kept.levels[l]->cbeginValueOn(); it; ++it) {
            if (!cut.levels[l]->isValueOn(it.getCoord())) continue;
            const Index3 c = toIndex(it.getCoord());
            const Vec3 centre = grid.lattice.cellBox(level, c).centre();
            if (index.closest(centre, RoomOptions().least * grid.lattice.h(level))) return fmt::format("cell {} {} {} has no room", c[0], c[1], c[2]);
            for (std::size_t d = 0; d < 6; ++d) {
                Index3 n = c;
                n[d / 2] += d % 2 ? 1 : -1;
                if (!kept.levels[l]->isValueOn(toCoord(n))) continue;
                if (index.firstHit(centre, grid.lattice.cellBox(level, n).centre())) return fmt::format("a wall beside cell {} {} {}", c[0], c[1], c[2]);
            }
        }
    }
    return "";
}

} // namespace i2b::test
