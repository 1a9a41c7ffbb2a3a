#include "i2b/edit/layer_column.h"
#include <algorithm>
#include <map>

namespace i2b {
namespace {

using Index = std::size_t;
using Loop = LayerColumn::Loop;

bool has(const Loop& loop, std::int32_t point) { return std::ranges::find(loop, point) != loop.end(); }

} // namespace

std::optional<LayerColumn> layerColumn(const PolyMesh& mesh, const Rows& cellFaces, std::int32_t wallFace, std::int32_t firstLayerCell) {
    std::int32_t base = wallFace, cell = mesh.owner[Index(base)];
    const auto first = mesh.face(base);
    LayerColumn column{{}, {Loop(first.begin(), first.end())}};
    while (cell >= firstLayerCell) {
        const Loop& below = column.levels.back();
        std::int32_t top = -1;
        std::map<std::int32_t, std::int32_t> up;
        for (const std::int32_t f : cellFaces[cell]) {
            if (f == base) continue;
            const auto v = mesh.face(f);
            if (std::ranges::none_of(v, [&](std::int32_t p) { return has(below, p); })) {
                if (top >= 0) return {};
                top = f;
                continue;
            }
            for (Index i = 0; i < v.size(); ++i) {
                const std::int32_t a = v[i], b = v[(i + 1) % v.size()];
                if (has(below, a) && !has(below, b)) up[a] = b;
                if (has(below, b) && !has(below, a)) up[b] = a;
            }
        }
        if (top < 0 || top >= mesh.internalFaces() || up.size() != below.size() || mesh.face(top).size() != below.size()) return {};
        Loop level;
        for (const std::int32_t p : below) level.push_back(up.at(p));
        for (const std::int32_t p : mesh.face(top))
            if (!has(level, p)) return {};
        column.cells.push_back(cell);
        column.levels.push_back(std::move(level));
        cell = mesh.owner[Index(top)] == cell ? mesh.neighbour[Index(top)] : mesh.owner[Index(top)];
        base = top;
    }
    return column.cells.empty() ? std::nullopt : std::optional(std::move(column));
}

} // namespace i2b
