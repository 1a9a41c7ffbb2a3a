#include "i2b/repair/mesh_nodes.h"
#include "i2b/core/parallel.h"
#include <algorithm>
#include <tbb/parallel_sort.h>

namespace i2b {
namespace {
using Index = std::size_t;
}

std::vector<std::uint8_t> mayMove(const Front& front, std::size_t points) {
    std::vector<std::uint8_t> may(points, 0);
    std::fill(may.begin() + front.corePoints, may.end(), std::uint8_t(1));
    for (Index v = 0; v < front.firstInserted(); ++v) may[Index(front.corePoint[v])] = 1;
    for (const std::int32_t p : front.movedPoints) may[Index(p)] = 1;
    return may;
}

MeshNodes::MeshNodes(Front& front, const LayerStack& layers)
    : front_(front), layers_(layers), core_(front.corePoints + static_cast<std::int32_t>(front.inserted.size())) {
    RawVector<Fan> fans(front.firstInserted());
    parallelFor(fans.size(), [&](Index v) { fans[v] = {front.corePoint[v], static_cast<std::int32_t>(v)}; }, 4096);
    tbb::parallel_sort(fans);
    points_.resize(fans.size()), vertices_.resize(fans.size());
    parallelFor(fans.size(), [&](Index i) { points_[i] = fans[i].point, vertices_[i] = fans[i].vertex; }, 4096);
    for (Index i = 0; i < front.inserted.size(); ++i) {
        for (std::int32_t end : front.inserted[i].ends) children_.push_back({end, static_cast<std::int32_t>(front.firstInserted() + i)});
    }
    std::sort(children_.begin(), children_.end());
    moved_.resize(front.movedPoints.size());
    parallelFor(moved_.size(), [&](Index i) { moved_[i] = {front.movedPoints[i], static_cast<std::int32_t>(i)}; }, 4096);
    tbb::parallel_sort(moved_);
}

std::pair<const std::int32_t*, const std::int32_t*> MeshNodes::fansOf(std::int32_t corePoint) const {
    const auto [first, last] = std::equal_range(points_.begin(), points_.end(), corePoint);
    return {vertices_.data() + (first - points_.begin()), vertices_.data() + (last - points_.begin())};
}

std::int32_t MeshNodes::movedPlace(std::int32_t point) const {
    const auto at = std::lower_bound(moved_.begin(), moved_.end(), MovedPoint{point, 0});
    return at != moved_.end() && at->point == point ? at->place : -1;
}

void MeshNodes::nodesOf(std::int32_t point, std::vector<MeshNode>& out) const {
    const auto first = static_cast<std::int32_t>(front_.firstInserted());
    const auto addFronts = [&](std::int32_t vertex) { // of an inserted vertex its edge's
        if (vertex < first) return out.push_back({MeshNode::front, front_.corePoint[Index(vertex)]});
        for (std::int32_t end : front_.inserted[Index(vertex - first)].ends) out.push_back({MeshNode::front, front_.corePoint[Index(end)]});
    };
    if (point >= core_) {
        const auto vertex = static_cast<std::int32_t>(layers_.vertexOfPoint(static_cast<Index>(point - core_)));
        out.push_back({MeshNode::wall, vertex});
        addFronts(vertex);
    } else if (point >= front_.corePoints) {
        const std::int32_t vertex = first + point - front_.corePoints;
        out.push_back({MeshNode::wall, vertex});
        addFronts(vertex);
    } else if (const auto [begin, end] = fansOf(point); begin != end) {
        out.push_back({MeshNode::front, point});
    } else if (const std::int32_t i = movedPlace(point); i >= 0) {
        out.push_back({MeshNode::core, i});
    }
}

Vec3 MeshNodes::place(const MeshNode& node) const {
    if (node.kind == MeshNode::core) return front_.movedTo[Index(node.id)];
    if (node.kind == MeshNode::wall) return front_.wall(Index(node.id));
    return front_.front[Index(*fansOf(node.id).first)];
}

double MeshNodes::h(const MeshNode& node) const {
    if (node.kind == MeshNode::core) return front_.movedSize[Index(node.id)];
    return front_.h[Index(node.kind == MeshNode::wall ? node.id : *fansOf(node.id).first)];
}

std::uint8_t MeshNodes::outside(const MeshNode& node) const {
    if (node.kind == MeshNode::core) return front_.movedOutside[Index(node.id)];
    return front_.outside[Index(node.kind == MeshNode::wall ? node.id : *fansOf(node.id).first)];
}

// The front position of a vertex with its wall position elsewhere.
Vec3 MeshNodes::frontUnder(std::int32_t vertex, const Vec3& wall) const {
    if (Index(vertex) < front_.firstInserted()) return front_.front[Index(vertex)];
    const Front::Inserted& i = front_.inserted[Index(vertex) - front_.firstInserted()];
    return i.frontAt(front_.front[Index(i.ends[0])], front_.front[Index(i.ends[1])], wall);
}

void MeshNodes::stack(std::int32_t vertex, const Vec3& front, const Vec3& wall, Moved& out) const {
    std::array<Vec3, maxStack + 1> points;
    placeLayers(layers_, Index(vertex), front, wall, points.data());
    const auto first = core_ + static_cast<std::int32_t>(layers_.pointOffset(Index(vertex)));
    for (int k = 0; k < layers_.pointsOf(Index(vertex)); ++k) out.emplace_back(first + k, points[Index(k)]);
}

void MeshNodes::follow(const MeshNode& node, const Vec3& to, Moved& out) const {
    if (node.kind == MeshNode::wall) {
        const Vec3 front = frontUnder(node.id, to);
        if (Index(node.id) >= front_.firstInserted()) out.emplace_back(front_.corePoint[Index(node.id)], front);
        return stack(node.id, front, to, out);
    }
    if (node.kind == MeshNode::core) {
        out.emplace_back(front_.movedPoints[Index(node.id)], to);
        return;
    }
    out.emplace_back(node.id, to);
    const auto [first, last] = fansOf(node.id);
    for (const std::int32_t* v = first; v != last; ++v) {
        stack(*v, to, front_.wall(Index(*v)), out);
        auto child = std::lower_bound(children_.begin(), children_.end(), Child{*v, 0});
        for (; child != children_.end() && child->parent == *v; ++child) {
            const Front::Inserted& i = front_.inserted[Index(child->vertex) - front_.firstInserted()];
            const bool atFirst = i.ends[0] == *v;
            const Vec3 other = front_.front[Index(i.ends[atFirst ? 1 : 0])];
            const Vec3 place = i.frontAt(atFirst ? to : other, atFirst ? other : to, front_.wall(Index(child->vertex)));
            out.emplace_back(front_.corePoint[Index(child->vertex)], place);
            stack(child->vertex, place, front_.wall(Index(child->vertex)), out);
        }
    }
}

void MeshNodes::moveTo(const MeshNode& node, const Vec3& to) {
    if (node.kind == MeshNode::core) {
        front_.movedTo[Index(node.id)] = to;
    } else if (node.kind == MeshNode::wall) {
        front_.front[Index(node.id)] = frontUnder(node.id, to);
        front_.mesh.set_point(FrontMesh::VertexHandle(node.id), {to.x, to.y, to.z});
    } else {
        const auto [first, last] = fansOf(node.id);
        for (const std::int32_t* v = first; v != last; ++v) {
            front_.front[Index(*v)] = to;
            auto child = std::lower_bound(children_.begin(), children_.end(), Child{*v, 0});
            for (; child != children_.end() && child->parent == *v; ++child) {
                const Front::Inserted& i = front_.inserted[Index(child->vertex) - front_.firstInserted()];
                front_.front[Index(child->vertex)] = i.frontAt(front_.front[Index(i.ends[0])], front_.front[Index(i.ends[1])], front_.wall(Index(child->vertex)));
            }
        }
    }
}

} // namespace i2b
