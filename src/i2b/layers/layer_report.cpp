#include "i2b/layers/layer_report.h"
#include "i2b/core/parallel.h"
#include "i2b/layers/layer_stack.h"
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace i2b {
namespace {

constexpr double asAsked = 0.99;  // of a height counts as all of it
constexpr double asHigh = 1.55;   // an innermost cell up to so much higher than its layer is one; see stackLevels()

// Means over the vertices of a face.
struct Means {
    double room = 0, size = 0;
    std::array<double, maxStack + 2> level{}; // m, from the wall; level[cells] is the room
};

Means meansOf(const Front& front, const LayerStack& stack, std::size_t face) {
    Means m;
    std::array<double, maxStack + 1> z{};
    const int cells = stack.cellsOf(face);
    int n = 0;
    for (auto vertex : front.mesh.fv_range(FrontMesh::FaceHandle(static_cast<int>(face)))) {
        const auto v = static_cast<std::size_t>(vertex.idx());
        const double room = roomAt(front, v);
        const int points = stack.pointsOf(v);
        stack.heights(v, room, z.data());
        for (int j = 1; j < cells; ++j) m.level[static_cast<std::size_t>(j)] += z[static_cast<std::size_t>(points - 1 - j)];
        m.room += room, m.size += front.h[v], ++n;
    }
    m.level[static_cast<std::size_t>(cells)] = m.room;
    for (int j = 1; j <= cells; ++j) m.level[static_cast<std::size_t>(j)] /= n;
    m.room /= n, m.size /= n;
    return m;
}

// Cells that are layers: all but the innermost, and that one where it is not much higher than its layer.
int achievedCount(const LayerPlan& plan, const Means& m, int cells, double first) {
    if (cells > plan.count) return plan.count;
    const auto c = static_cast<std::size_t>(cells);
    const double asked = first * std::pow(plan.growth, cells - 1);
    return m.level[c] - m.level[c - 1] <= asHigh * asked ? cells : cells - 1;
}

} // namespace

WallLayers measureLayers(const Front& front, const LayerStack& stack) {
    WallLayers w;
    const std::size_t faces = stack.faces;
    w.wallCell.resize(faces), w.asked.resize(faces), w.achieved.resize(faces), w.cause.resize(faces);
    w.first.resize(faces), w.thickness.resize(faces), w.askedFirst.resize(faces), w.askedThickness.resize(faces);
    parallelFor(faces, [&](std::size_t f) {
        const LayerPlan& plan = stack.planOfFace(f);
        const int cells = stack.cellsOf(f);
        const Means m = meansOf(front, stack, f);
        const double first = askedFirst(plan, m.room, m.size), thickness = askedThickness(plan, m.room, m.size);
        const int achieved = achievedCount(plan, m, cells, first);
        LayerCause cause = LayerCause::none;
        if (achieved < plan.count) {
            cause = LayerCause::taper;
        } else if (m.level[static_cast<std::size_t>(achieved)] < asAsked * thickness) {
            cause = m.level[1] < asAsked * first ? LayerCause::room : LayerCause::compressed;
        }
        w.wallCell[f] = static_cast<std::int32_t>(stack.cellOffset(f)) + cells - 1;
        w.asked[f] = static_cast<std::uint8_t>(plan.count);
        w.achieved[f] = static_cast<std::uint8_t>(achieved);
        w.cause[f] = cause;
        w.first[f] = static_cast<float>(m.level[1]);
        w.thickness[f] = static_cast<float>(m.level[static_cast<std::size_t>(achieved)]);
        w.askedFirst[f] = static_cast<float>(first);
        w.askedThickness[f] = static_cast<float>(thickness);
    });
    return w;
}

void settleCells(WallLayers& walls, const LayerStack& stack, std::int32_t firstLayerCell, const std::vector<std::int32_t>& cellOf,
                 const std::vector<std::int32_t>& morePieces) {
    walls.pieces.assign(morePieces.empty() ? 0 : walls.wallCell.size(), 1);
    parallelFor(walls.wallCell.size(), [&](std::size_t f) {
        const std::int32_t last = firstLayerCell + walls.wallCell[f], first = last - stack.cellsOf(f) + 1;
        walls.wallCell[f] = last;
        if (cellOf.empty()) return;
        const auto now = [&](std::int32_t cell) { return cellOf[static_cast<std::size_t>(cell)]; };
        walls.wallCell[f] = now(last);
        if (!walls.pieces.empty()) {
            const auto [from, to] = std::ranges::equal_range(morePieces, last);
            walls.pieces[f] = static_cast<std::uint8_t>(1 + (to - from));
        }
        std::array<std::int32_t, maxStack + 2> cells{};
        int n = 0;
        for (std::int32_t c = first; c <= last; ++c) cells[static_cast<std::size_t>(n++)] = now(c);
        std::sort(cells.begin(), cells.begin() + n);
        const auto left = static_cast<int>(std::unique(cells.begin(), cells.begin() + n) - cells.begin());
        if (left >= walls.achieved[f]) return;
        walls.achieved[f] = static_cast<std::uint8_t>(left);
        walls.cause[f] = LayerCause::merged;
    });
}

void dropFaces(WallLayers& walls, const std::vector<std::int32_t>& cells) {
    if (cells.empty()) return;
    if (walls.pieces.empty()) walls.pieces.assign(walls.wallCell.size(), 1);
    std::vector<std::int32_t> left = cells;
    for (std::size_t f = 0; f < walls.wallCell.size() && !left.empty(); ++f) {
        const auto [from, to] = std::ranges::equal_range(left, walls.wallCell[f]);
        const auto dropped = std::min<std::ptrdiff_t>(to - from, walls.pieces[f]);
        walls.pieces[f] = static_cast<std::uint8_t>(walls.pieces[f] - dropped);
        left.erase(from, from + dropped);
    }
}

void renumber(WallLayers& walls, const std::vector<std::int32_t>& cellOf) {
    if (cellOf.empty()) return;
    parallelFor(walls.wallCell.size(), [&](std::size_t f) { walls.wallCell[f] = cellOf[static_cast<std::size_t>(walls.wallCell[f])]; });
}

void sortByCell(WallLayers& walls) {
    const std::vector<std::int32_t>& cells = walls.wallCell;
    if (walls.pieces.empty() && std::ranges::adjacent_find(cells, std::ranges::greater_equal()) == cells.end()) return;
    std::vector<std::size_t> order(cells.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    if (!walls.pieces.empty()) std::erase_if(order, [&](std::size_t f) { return walls.pieces[f] == 0; });
    std::ranges::stable_sort(order, {}, [&](std::size_t f) { return cells[f]; });
    const auto [from, to] = std::ranges::unique(order, {}, [&](std::size_t f) { return cells[f]; });
    order.erase(from, to);
    const auto pick = [&](auto& values) {
        if (values.empty()) return;
        std::remove_reference_t<decltype(values)> picked(order.size());
        std::ranges::transform(order, picked.begin(), [&](std::size_t f) { return values[f]; });
        values = std::move(picked);
    };
    pick(walls.asked), pick(walls.achieved), pick(walls.cause), pick(walls.first), pick(walls.thickness);
    pick(walls.askedFirst), pick(walls.askedThickness), pick(walls.pieces), pick(walls.wallCell);
}

LayerReport summarize(const WallLayers& walls, const Front& front, const std::vector<Part>& parts, int requested) {
    LayerReport report;
    report.requested = requested;
    report.minFirst = std::numeric_limits<double>::infinity();
    std::vector<LayerRow> rows(parts.size());
    std::vector<std::int64_t> layered(parts.size(), 0);
    double fraction = 0, first = 0;
    std::int64_t asking = 0, covered = 0, layers = 0;
    std::int64_t faces = 0;
    const auto add = [&](std::size_t f) {
        const auto part = static_cast<std::size_t>(front.part[f]);
        LayerRow& row = rows[part];
        ++row.faces, ++faces;
        row.asked = walls.asked[f];
        row.askedFirst += static_cast<double>(walls.askedFirst[f]);
        row.askedThickness += static_cast<double>(walls.askedThickness[f]);
        ++row.causes[static_cast<std::size_t>(walls.cause[f])];
        row.meanCount += walls.achieved[f];
        layers += walls.achieved[f];
        const auto height = static_cast<double>(walls.first[f]), thickness = static_cast<double>(walls.thickness[f]);
        if (walls.asked[f] > 0) {
            ++asking;
            fraction += std::min(1.0, thickness / std::max(1e-300, static_cast<double>(walls.askedThickness[f])));
        }
        if (walls.achieved[f] == 0) return;
        ++covered, ++layered[part];
        first += height;
        row.meanFirst += height, row.meanThickness += thickness;
        report.minFirst = std::min(report.minFirst, height);
        report.maxFirst = std::max(report.maxFirst, height);
    };
    for (std::size_t f = 0; f < walls.asked.size(); ++f)
        for (int piece = walls.pieces.empty() ? 1 : walls.pieces[f]; piece > 0; --piece) add(f);
    const auto per = [](double sum, std::int64_t n) { return n > 0 ? sum / static_cast<double>(n) : 0; };
    report.meanCount = per(static_cast<double>(layers), faces);
    report.facesCoveredFraction = per(static_cast<double>(covered), faces);
    report.thicknessFraction = asking > 0 ? per(fraction, asking) : 1;
    report.meanFirst = per(first, covered);
    if (covered == 0) report.minFirst = 0;
    for (std::size_t p = 0; p < rows.size(); ++p) {
        LayerRow& row = rows[p];
        if (row.faces == 0) continue;
        row.part = parts[p].name;
        for (double* sum : {&row.askedFirst, &row.askedThickness, &row.meanCount}) *sum = per(*sum, row.faces);
        for (double* sum : {&row.meanFirst, &row.meanThickness}) *sum = per(*sum, layered[p]);
        report.parts.push_back(row);
    }
    return report;
}

} // namespace i2b
