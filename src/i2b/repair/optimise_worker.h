// What a thread of the optimiser needs to try moves.
#pragma once
#include "i2b/repair/cell_star.h"
#include "i2b/repair/optimise.h"
#include <algorithm>
#include <array>

namespace i2b {

// What all moves keep to.
inline constexpr double probe = 1e-3;     // of h: step of the differences that give the direction of descent
inline constexpr double leastGain = 1e-3; // of the sum: what a move must bring
inline constexpr std::array<double, 3> towardsMiddle{0.6, 0.3, 0.1};                      // of the way
inline constexpr std::array<double, 5> stepLengths{0.25, 0.12, 0.06, 0.03, 0.015};        // of h
inline constexpr std::array<float, 5> bends{1, 0.75f, 0.5f, 0.25f, 0}; // of columns

struct Optimiser::Worker {
    Worker(Optimiser& o) : optimiser(o), star(o.mesh_, o.cellFaces_, o.faults_.moments(), o.faults_.limits(), o.faults_.thinFrom(),
             o.faults_.countsThinWeights()) {
        star.countFlat(o.leastFull_);
    }

    void begin(const Task& t) {
        hang(t);
        star.take(points, t.star->cells);
    }
    // The cells at all points that hang on the node.
    const std::vector<std::int32_t>& cellsOf(const Task& t) {
        hang(t);
        return star.cellsAt(points, {t.cell});
    }
    void hang(const Task& t) {
        node = t.node;
        from = optimiser.nodes_.place(node);
        moved.clear();
        optimiser.nodes_.follow(node, from, moved);
        points.clear();
        for (const auto& [p, x] : moved) points.push_back(p);
        std::sort(points.begin(), points.end());
        points.erase(std::unique(points.begin(), points.end()), points.end());
    }
    Badness at(const Vec3& to) {
        put(to);
        return star.judge();
    }
    Badness at(const Vec3& to, const Badness& before, double most) {
        put(to);
        return star.judge(before, most);
    }
    // Of the places that at() and tetsAt() were asked about first: the same sums a little beside, where nothing else comes in.
    double sumBeside(const Vec3& to) {
        put(to);
        return star.sumNearby();
    }
    double tetSumBeside(const Vec3& to) {
        put(to);
        return star.tetSumNearby();
    }
    bool mayStandAt(const Vec3& to, const Badness& before) {
        put(to);
        return star.mayStand(before);
    }
    TetLack tetsAt(const Vec3& to, double most = std::numeric_limits<double>::infinity()) {
        put(to);
        return star.judgeTets(most);
    }
    bool mayDivideAt(const Vec3& to, const TetLack& before) {
        put(to);
        return star.mayDivide(before);
    }
    void put(const Vec3& to) {
        moved.clear();
        optimiser.nodes_.follow(node, to, moved);
        for (const auto& [p, x] : moved) optimiser.mesh_.points[static_cast<std::size_t>(p)] = x;
    }
    // Unit; 0 where there is none. value: of the places around, `here` where the node is; axes of the sides that it lies in are
    // left alone.
    template <class F>
    Vec3 descent(double here, double step, std::uint8_t outside, const F& value) const {
        Vec3 down;
        for (int axis = 0; axis < 3; ++axis) {
            if (outside >> (2 * axis) & 3) continue;
            Vec3 to = from;
            to[axis] += step;
            down[axis] = here - value(to);
        }
        return normalized(down);
    }
    // Of those at the node where it is.
    double shortestEdge() const { return star.shortestEdgeAt(ownPoint()); }
    // Of its neighbours, with the node where it is.
    Vec3 middle() const { return star.middleOf(ownPoint()); }
    // Of a front or core node the first of those that hang on it; of a wall node the last of its stack, at the wall.
    std::int32_t ownPoint() const { return node.kind == MeshNode::wall ? moved.back().first : moved.front().first; }
    // Leaves the node at a place.
    void end(const Vec3& to) {
        put(to);
        if (!(to == from)) optimiser.nodes_.moveTo(node, to);
    }

    Optimiser& optimiser;
    CellStar star;
    MeshNode node;
    Vec3 from;
    MeshNodes::Moved moved;
    std::vector<std::int32_t> points;
};

} // namespace i2b
