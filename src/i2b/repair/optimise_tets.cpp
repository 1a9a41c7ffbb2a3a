// Moves that make faces divide into tetrahedra.
#include "i2b/core/quantile.h"
#include "i2b/fit/corner.h"
#include "i2b/repair/optimise_worker.h"
#include <cmath>
#include <optional>

namespace i2b {
namespace {

using Index = std::size_t;
const double folded = std::cos(25 * 3.14159265358979323846 / 180); // wall faces that a sharp edge parts
constexpr double enough = 0.5;      // of the sum: what is less need not be bettered
// Of the size of the wall's faces: so far off the geometry a node still counts as on it.
constexpr std::array<double, 3> hair{0.009, 0.006, 0.003};
constexpr double mostOff = 0.2;     // of h: where it must leave the geometry
constexpr std::array<double, 3> openings{0.1, 0.05, 0.025}; // of h
constexpr double narrow = 0.1;      // area of a wall face, as seen from its front, over the square of its size

} // namespace

// Does the wall stay folded along the lines that its nodes are held to, with a node of it elsewhere?
bool Optimiser::keepsFolds(const MeshNode& node, const Vec3& to) const {
    if (node.kind != MeshNode::wall) return true;
    const FrontMesh& wall = front_.mesh;
    const auto onLine = [&](int v) { return Index(v) >= guide_.snaps.size() || guide_.snaps[Index(v)].kind != SnapKind::none; }; // inserted ones are
    const auto normalOf = [&](FrontMesh::FaceHandle f, bool moved) {
        const auto place = [&](int v) { return moved && v == node.id ? to : front_.wall(Index(v)); };
        Vec3 first, last, twice;
        int n = 0;
        for (auto v : wall.fv_range(f)) {
            const Vec3 p = place(v.idx());
            if (n++ == 0) first = p;
            else twice += cross(last - first, p - first);
            last = p;
        }
        return normalized(twice);
    };
    for (auto f : wall.vf_range(FrontMesh::VertexHandle(node.id))) {
        for (auto he : wall.fh_range(f)) {
            const auto other = wall.opposite_face_handle(he);
            if (!other.is_valid() || !onLine(wall.from_vertex_handle(he).idx()) || !onLine(wall.to_vertex_handle(he).idx())) continue;
            if (dot(normalOf(f, false), normalOf(other, false)) <= folded && dot(normalOf(f, true), normalOf(other, true)) > folded) return false;
        }
    }
    return true;
}

// Of the faces at a wall vertex the median, of each the median of its edges: at most what the fit is judged by, mostly. m
double Optimiser::sizeAt(std::int32_t vertex) const {
    const FrontMesh& wall = front_.mesh;
    std::vector<double> sizes, edges;
    for (auto f : wall.vf_range(FrontMesh::VertexHandle(vertex))) {
        edges.clear();
        for (auto he : wall.fh_range(f))
            edges.push_back(norm(front_.wall(Index(wall.to_vertex_handle(he).idx())) - front_.wall(Index(wall.from_vertex_handle(he).idx()))));
        sizes.push_back(median(edges));
    }
    return median(sizes);
}

// The way in which a wall vertex widens the narrowest of its faces, unit; none where all are wide. Out of the front's cells a face
// has the area 1/2 sum x_i x x_(i+1), which grows most as the vertex moves across its two neighbours.
Vec3 Optimiser::wayToOpen(std::int32_t vertex) const {
    const FrontMesh& wall = front_.mesh;
    const FrontMesh::VertexHandle own(vertex);
    Vec3 way;
    double least = narrow;
    for (auto f : wall.vf_range(own)) {
        Vec3 twice, out, before, next;
        double size2 = 0;
        for (auto he : wall.fh_range(f)) {
            const auto a = wall.from_vertex_handle(he), b = wall.to_vertex_handle(he);
            const Vec3 p = front_.wall(Index(a.idx())) - front_.wall(Index(vertex)), q = front_.wall(Index(b.idx())) - front_.wall(Index(vertex));
            twice += cross(p, q), out += front_.wall(Index(a.idx())) - front_.front[Index(a.idx())];
            size2 = std::max(size2, norm2(q - p));
            if (b == own) before = p;
            if (a == own) next = q;
        }
        out = normalized(out);
        const double width = 0.5 * dot(twice, out) / size2;
        if (width < least) least = width, way = normalized(cross(next - before, out));
    }
    return way;
}

// Back towards where it was on the geometry, as far as every face goes on dividing.
bool Optimiser::bringBack(const Task& task, const Vec3& to, Worker& worker) {
    worker.begin(task);
    const Vec3 from = worker.from;
    const TetLack now = worker.tetsAt(from);
    const Badness limits = worker.at(from);
    for (const double share : {1.0, 0.5, 0.25}) {
        const Vec3 place = from + (to - from) * share;
        const TetLack there = worker.tetsAt(place);
        if ((there.undivided && !(now.undivided && there.sum < now.sum)) || !worker.mayStandAt(place, limits) || !isFree(task.node, place)) continue;
        worker.end(place);
        return true;
    }
    worker.end(from);
    return false;
}

// Bends a wall node's column another way where that lowers the sum of tetrahedra's lack, with the node at a place.
bool Optimiser::bendForTets(const Task& task, Worker& worker, const Vec3& at, double& least) {
    float* bend = bendOf(task.node);
    if (!bend) return false;
    const float was = *bend;
    const Badness limits = worker.at(at);
    float best = was;
    for (const float value : bends) {
        *bend = value;
        const double tets = worker.tetsAt(at, least).sum;
        if (tets < least * (1 - leastGain) && worker.mayStandAt(at, limits)) least = tets, best = value;
    }
    *bend = best;
    return best != was;
}

bool Optimiser::mendNodeTets(const Task& task, Worker& worker) {
    const std::uint8_t outside = nodes_.outside(task.node);
    const bool leaves = task.node.kind == MeshNode::wall && mayLeave(task.node);
    if (task.node.kind == MeshNode::wall && outside != 0 && !leaves) return false;
    worker.begin(task);
    const Vec3 from = worker.from;
    const TetLack before = worker.tetsAt(from);
    if (!before.undivided) return false;
    std::optional<Badness> limits; // where it is; asked for where they are broken
    const auto keepsLimits = [&](const Vec3& to) {
        if (worker.mayStandAt(to, {})) return true;
        if (!limits) limits = worker.at(from);
        return worker.mayStandAt(to, *limits);
    };
    const Hold hold = holdAt(task.node, from);
    const Vec3 toMiddle = withinSides(worker.middle() - from, outside);
    Vec3 best = from;
    double least = before.sum * (1 - leastGain);
    const auto tryPlace = [&](const Vec3& to) {
        const double tets = worker.tetsAt(to, least).sum; // what is cheap to ask comes first
        if (tets < least && isFree(task.node, to) && (leaves || keepsFolds(task.node, to)) && keepsLimits(to)) least = tets, best = to;
    };
    const auto tryStep = [&](const Vec3& step) {
        if (least == 0) return;
        const Vec3 to = onWall(hold, task.node, from, from + step);
        if (!leaves || guide_.index.closest(to, mostOff * nodes_.h(task.node))) tryPlace(to);
    };
    for (const double share : towardsMiddle) tryStep(toMiddle * share);
    if (task.node.kind == MeshNode::wall && least > enough * before.sum) {
        // Faces that wrap the rim of a sheet without thickness have no width: a hair's breadth opens them.
        const Vec3 toFront = normalized(front_.front[Index(task.node.id)] - from), open = wayToOpen(task.node.id);
        // No farther than onWall() takes for on the geometry, too: what is off is free to go anywhere.
        const double size = std::min(sizeAt(task.node.id), nodes_.h(task.node)), most = (leaves ? mostOff : hair.front()) * size;
        const bool isOff = !guide_.index.closest(from, most);
        const auto tryWay = [&](const Vec3& way, const std::array<double, 3>& lengths) {
            for (const double length : lengths) {
                const Vec3 to = from + way * (length * size);
                if (isOff || guide_.index.closest(to, most)) tryPlace(to);
            }
        };
        for (const Vec3& free : {toFront, open}) {
            const Vec3 way = withinSides(free, outside);
            if (way == Vec3{}) continue;
            tryWay(way, hair);
            if (leaves) tryWay(way, openings);
        }
    }
    if (least > enough * before.sum) {
        const double h = nodes_.h(task.node);
        const Vec3 down = worker.descent(before.sum, probe * h, outside, [&](const Vec3& to) { return worker.tetSumBeside(to); });
        for (const double length : stepLengths) tryStep(down * (length * h));
        // Few faces come as far: their nodes try all ways round before they are given up.
        if (isLast_ && !(least < before.sum * (1 - leastGain))) {
            for (int i = 0; i < 27; ++i) {
                const Vec3 way = withinSides({double(i % 3 - 1), double(i / 3 % 3 - 1), double(i / 9 - 1)}, outside);
                if (way == Vec3{}) continue;
                for (const double length : {0.25, 0.1, 0.05, 0.02, 0.008}) tryStep(normalized(way) * (length * h));
            }
        }
    }
    const bool isBent = least > 0 && bendForTets(task, worker, best, least);
    worker.end(best);
    return isBent || !(best == from);
}

} // namespace i2b
