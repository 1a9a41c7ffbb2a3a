#include "i2b/core/error.h"
#include "i2b/core/parallel.h"
#include "i2b/geometry/part_names.h"
#include "i2b/layers/layer_stack.h"
#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <limits>
#include <numeric>

namespace i2b {
namespace {

constexpr double thinShare = 0.3, flatShare = 0.11; // of the room, that the lowest of thin and of flat layers is under,
constexpr double thinHeight = 0.6; // and that those of a given height are under which columns should bend for

FrontMesh::FaceHandle faceAt(std::size_t f) { return FrontMesh::FaceHandle(static_cast<int>(f)); }
FrontMesh::VertexHandle vertexAt(std::size_t v) { return FrontMesh::VertexHandle(static_cast<int>(v)); }

// Cells that each face would have without neighbours.
std::vector<std::uint8_t> wantedCounts(const Front& front, const LayerStack& stack) {
    std::vector<std::uint8_t> counts(stack.faces);
    parallelFor(stack.faces, [&](std::size_t f) {
        double room = 0, h = 0;
        int n = 0;
        for (auto v : front.mesh.fv_range(faceAt(f))) {
            const auto i = static_cast<std::size_t>(v.idx());
            room += roomAt(front, i), h += front.h[i], ++n;
        }
        counts[f] = static_cast<std::uint8_t>(wantedCells(stack.planOfFace(f), room / n, h / n));
    });
    return counts;
}

// The order in which plans have a say where they meet: more layers first, then lower ones, then as given.
std::vector<std::uint16_t> rankPlans(const std::vector<LayerPlan>& plans) {
    std::vector<std::uint16_t> order(plans.size()), rank(plans.size());
    std::iota(order.begin(), order.end(), std::uint16_t(0));
    const auto first = [&](std::uint16_t p) { return plans[p].fills() ? std::numeric_limits<double>::infinity() : plans[p].first; };
    std::stable_sort(order.begin(), order.end(), [&](std::uint16_t a, std::uint16_t b) {
        return plans[a].count != plans[b].count ? plans[a].count > plans[b].count : first(a) < first(b);
    });
    for (std::size_t i = 0; i < order.size(); ++i) rank[order[i]] = static_cast<std::uint16_t>(i);
    return rank;
}

// Points and plan of each vertex: those of the highest stack around it.
void countPoints(const Front& front, const std::vector<std::uint8_t>& counts, LayerStack& stack) {
    const std::vector<std::uint16_t> rank = rankPlans(stack.plans);
    const bool several = stack.plans.size() > 1;
    stack.pointOffsets.assign(stack.vertices + 1, 0);
    if (several) stack.vertexPlan.resize(stack.vertices);
    parallelFor(stack.vertices, [&](std::size_t v) {
        int most = 0;
        std::uint16_t plan = 0;
        for (auto face : front.mesh.vf_range(vertexAt(v))) {
            const auto f = static_cast<std::size_t>(face.idx());
            const std::uint16_t mine = several ? stack.facePlan[f] : std::uint16_t(0);
            const int cells = counts[f];
            if (cells > most || (cells == most && rank[mine] < rank[plan])) most = cells, plan = mine;
        }
        stack.pointOffsets[v] = static_cast<std::uint32_t>(most);
        if (several) stack.vertexPlan[v] = plan;
    });
}

void requireFew(std::uint64_t labels) {
    if (labels < std::uint64_t(std::numeric_limits<std::int32_t>::max())) return;
    throw Error(ErrorKind::input, fmt::format("{} layer cells are more than a mesh of 32-bit labels can hold", labels), "",
                "give a larger --size or fewer --layers");
}

} // namespace

double roomAt(const Front& front, std::size_t vertex) {
    return norm(front.wall(vertex) - front.front[vertex]);
}

WallPlans plansOf(const LayerOptions& options, const std::vector<Part>& parts) {
    WallPlans out;
    out.plans.push_back(planOf(requestOf(options), options.unit));
    if (options.parts.empty()) return out;
    if (options.parts.size() > std::numeric_limits<std::uint16_t>::max() - 1U) {
        throw Error(ErrorKind::usage, fmt::format("{} rules for layers are too many", options.parts.size()), "part-layers", "use expressions");
    }
    out.ofPart.assign(parts.size(), 0);
    for (const PartLayers& rule : options.parts) {
        const NamePattern pattern(rule.part);
        bool found = false;
        for (std::size_t p = 0; p < parts.size(); ++p) {
            if (pattern.matches(parts[p].name)) out.ofPart[p] = static_cast<std::uint16_t>(out.plans.size()), found = true;
        }
        if (!found) out.notes.push_back(fmt::format("no part is named '{}', which has layers of its own", rule.part));
        out.plans.push_back(planOf(requestOf(options, rule), options.unit));
    }
    return out;
}

RoomOfWalls roomWanted(const WallPlans& plans) {
    const auto roomOf = [](const LayerPlan& plan) { return plan.relative ? WantedRoom{0, plan.room()} : WantedRoom{plan.room(), 0}; };
    RoomOfWalls room;
    if (plans.ofPart.empty()) {
        room.most = roomOf(plans.plans.front());
        return room;
    }
    for (const std::uint16_t p : plans.ofPart) {
        const WantedRoom wanted = room.ofPart.emplace_back(roomOf(plans.plans[p]));
        room.most = {std::max(room.most.metres, wanted.metres), std::max(room.most.cells, wanted.cells)};
    }
    return room;
}

namespace {

// Of the room at the vertices of each plan, the share that the lowest cell takes on average; the least of all plans.
double leastShareOf(const Front& front, const LayerStack& stack) {
    struct Sum {
        double shares = 0, vertices = 0;
    };
    using Sums = std::vector<Sum>; // per plan
    const auto body = [&](std::size_t begin, std::size_t end) {
        Sums sums(stack.plans.size());
        std::array<double, maxStack + 1> heights;
        for (std::size_t v = begin; v < end; ++v) {
            const int n = stack.pointsOf(v);
            const double room = roomAt(front, v);
            Sum& sum = sums[stack.vertexPlan.empty() ? 0 : stack.vertexPlan[v]];
            if (n > 1) stack.heights(v, room, heights.data());
            sum.shares += n > 1 && room > 0 ? heights[static_cast<std::size_t>(n) - 2] / room : 1, ++sum.vertices;
        }
        return sums;
    };
    const auto join = [](Sums a, const Sums& b) {
        for (std::size_t p = 0; p < a.size(); ++p) a[p].shares += b[p].shares, a[p].vertices += b[p].vertices;
        return a;
    };
    double least = 1;
    for (const Sum& sum : orderedReduce(stack.vertices, Sums(stack.plans.size()), body, join))
        if (sum.vertices > 0) least = std::min(least, sum.shares / sum.vertices);
    return least;
}

LayerStack countLayers(const Front& front, const WallPlans& plans) {
    LayerStack stack;
    stack.plans = plans.plans;
    stack.faces = front.ownerCell.size();
    stack.vertices = front.front.size();
    if (!plans.ofPart.empty()) {
        stack.facePlan.resize(stack.faces);
        parallelFor(stack.faces, [&](std::size_t f) { stack.facePlan[f] = plans.ofPart[static_cast<std::size_t>(front.part[f])]; });
    }
    if (plans.plans.front().relative) {
        stack.cellSize.resize(stack.vertices);
        parallelFor(stack.vertices, [&](std::size_t v) { stack.cellSize[v] = static_cast<float>(front.h[v]); });
    }
    stack.count = std::max(1, plans.plans.front().count);
    if (plans.ofPart.empty() && plans.plans.front().fills()) return stack; // all alike
    std::vector<std::uint8_t> counts = wantedCounts(front, stack);
    taperCounts(front.mesh, counts);
    const auto [least, most] = std::minmax_element(counts.begin(), counts.end());
    stack.count = counts.empty() ? 1 : *most;
    const bool alike = counts.empty() || *least == *most;
    if (alike && stack.plans.size() == 1) return stack;
    countPoints(front, counts, stack);
    stack.cellOffsets.assign(counts.begin(), counts.end());
    stack.cellOffsets.push_back(0);
    requireFew(std::accumulate(counts.begin(), counts.end(), std::uint64_t(0)));
    requireFew(std::accumulate(stack.pointOffsets.begin(), stack.pointOffsets.end(), std::uint64_t(0)));
    exclusiveScan(stack.cellOffsets);
    exclusiveScan(stack.pointOffsets);
    return stack;
}

} // namespace

LayerStack makeLayers(const Front& front, const WallPlans& plans) {
    LayerStack stack = countLayers(front, plans);
    stack.leastShare = leastShareOf(front, stack);
    return stack;
}

LayerStack makeLayers(const Front& front, const LayerOptions& options) {
    WallPlans plans;
    plans.plans.push_back(planOf(requestOf(options), options.unit));
    return makeLayers(front, plans);
}

bool LayerStack::areThin() const {
    return leastShare < (std::ranges::all_of(plans, &LayerPlan::fills) ? thinShare : thinHeight);
}

bool LayerStack::areFlat() const { return leastShare < flatShare; }

std::size_t LayerStack::vertexOfPoint(std::size_t point) const {
    if (uniform()) return point / static_cast<std::size_t>(count);
    return static_cast<std::size_t>(std::upper_bound(pointOffsets.begin(), pointOffsets.end(), point) - pointOffsets.begin()) - 1;
}

std::size_t LayerStack::faceOfCell(std::size_t cell) const {
    if (uniform()) return cell / static_cast<std::size_t>(count);
    return static_cast<std::size_t>(std::upper_bound(cellOffsets.begin(), cellOffsets.end(), cell) - cellOffsets.begin()) - 1;
}

void LayerStack::heights(std::size_t vertex, double room, double* out) const {
    const int n = pointsOf(vertex);
    stackLevels(planOfVertex(vertex), room, cellSize.empty() ? 1.0 : static_cast<double>(cellSize[vertex]), n, out);
    std::reverse(out, out + n - 1);
    out[n - 1] = 0;
}

void placeLayers(const LayerStack& layers, std::size_t vertex, const Vec3& front, const Vec3& wall, const double* heights, Vec3* out) {
    const Vec3 way = front - wall;
    const double room = norm(way);
    const auto n = static_cast<std::size_t>(layers.pointsOf(vertex));
    const Column column = layers.columns.empty() ? Column() : layers.columns[vertex];
    const Vec3 aside = column.bend > 0 ? (column.normal() * room - way) * double(column.bend) : Vec3{};
    for (std::size_t k = 0; k + 1 < n; ++k) {
        const double s = room > 0 ? heights[k] / room : 0;
        out[k] = wall + way * s;
        if (column.bend > 0) out[k] += aside * (s - s * s);
    }
    out[n - 1] = wall;
}

void placeLayers(const LayerStack& layers, std::size_t vertex, const Vec3& front, const Vec3& wall, Vec3* out) {
    std::array<double, maxStack + 1> heights;
    if (layers.pointsOf(vertex) > 1) layers.heights(vertex, norm(front - wall), heights.data());
    placeLayers(layers, vertex, front, wall, heights.data(), out);
}

std::string LayerStack::validate(const Front& front) const {
    if (faces != front.ownerCell.size() || vertices != front.front.size() || plans.empty()) return "sizes of arrays";
    if (!uniform() && (cellOffsets.size() != faces + 1 || pointOffsets.size() != vertices + 1)) return "sizes of arrays";
    for (std::size_t f = 0; f < faces; ++f) {
        const int mine = cellsOf(f);
        if (mine < 1) return fmt::format("face {} has no cell", f);
        for (auto he : front.mesh.fh_range(faceAt(f))) {
            const auto other = front.mesh.opposite_face_handle(he);
            if (other.is_valid() && std::abs(mine - cellsOf(static_cast<std::size_t>(other.idx()))) > 1)
                return fmt::format("faces {} and {} differ by more than a cell", f, other.idx());
            const auto v = static_cast<std::size_t>(front.mesh.to_vertex_handle(he).idx());
            if (pointsOf(v) < mine) return fmt::format("vertex {} has {} points where face {} has {} cells", v, pointsOf(v), f, mine);
        }
    }
    std::vector<double> z;
    for (std::size_t v = 0; v < vertices; ++v) {
        z.resize(static_cast<std::size_t>(pointsOf(v)));
        double below = roomAt(front, v);
        heights(v, below, z.data());
        for (double height : z) {
            if (!(height < below)) return fmt::format("points of vertex {} do not fall to the wall", v);
            below = height;
        }
    }
    return "";
}

} // namespace i2b
