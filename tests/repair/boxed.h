// A mesh around a box along the axes, with what the optimiser needs.
#pragma once
#include "i2b/repair/optimise.h"
#include "pipeline/stages_run.h"
#include <algorithm>

namespace i2b::test {

inline QualityLimits limitsOf(double nonOrthogonality = 37) { // stricter than repair: a box is easy
    QualityLimits limits;
    limits.nonOrthogonality = nonOrthogonality;
    limits.skewness = 3.8;
    limits.faceWeight = 0.055, limits.volumeRatio = 0.02, limits.determinant = 0.0015;
    return limits;
}

struct Boxed {
    // thin: the layer on the wall counts as thin cells.
    explicit Boxed(const QualityLimits& limits = limitsOf(), bool thin = false)
        : run(flushHalves(), stagesOptions()), cellFaces(buildCellFaces(run.mesh)), thinFrom(run.mesh.cells - (thin ? static_cast<std::int32_t>(run.layers.cells()) : 0)),
          faults(run.mesh, cellFaces, limits, thinFrom),
          wishes(run.fitted.snaps.size()),
          optimiser(run.mesh, cellFaces, faults, run.front, run.layers, {*run.painted.index, run.features, run.fitted.snaps, wishes}) {}

    std::int64_t poor() const {
        FaultCount count;
        faults.poorCells(count);
        return count.all;
    }
    // The free wall vertex nearest to p.
    std::size_t nodeAt(const Vec3& p) const {
        std::size_t best = run.front.firstInserted();
        for (std::size_t v = 0; v < run.front.firstInserted(); ++v) {
            if (run.fitted.snaps[v].kind != SnapKind::none) continue;
            if (best == run.front.firstInserted() || norm2(wallPoint(run.front, v) - p) < norm2(wallPoint(run.front, best) - p)) best = v;
        }
        return best;
    }
    Vec3 wallOf(std::size_t v) const { return wallPoint(run.front, v); }
    void put(std::size_t v, const Vec3& to) {
        MeshNodes nodes(run.front, run.layers);
        const MeshNode node{MeshNode::wall, static_cast<std::int32_t>(v)};
        MeshNodes::Moved moved;
        nodes.follow(node, to, moved);
        std::vector<std::int32_t> points, seeds;
        for (const auto& [p, x] : moved) run.mesh.points[static_cast<std::size_t>(p)] = x, points.push_back(p);
        for (std::int32_t f = 0; f < run.mesh.faces(); ++f) {
            const auto face = run.mesh.face(f);
            if (std::ranges::find(face, points.back()) != face.end()) seeds.push_back(run.mesh.owner[static_cast<std::size_t>(f)]);
        }
        faults.update(points, seeds);
        nodes.moveTo(node, to);
    }
    double offWall(std::size_t v) const { return run.painted.index->closest(wallOf(v)).distance; }
    ToMesh run;
    Rows cellFaces;
    std::int32_t thinFrom;
    MeshFaults faults;
    std::vector<Snap> wishes;
    Optimiser optimiser;
};

} // namespace i2b::test
