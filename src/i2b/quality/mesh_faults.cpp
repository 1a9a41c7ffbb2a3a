#include "i2b/quality/mesh_faults.h"
#include "i2b/core/collect.h"
#include "i2b/core/flags.h"
#include "i2b/quality/face_tets.h"
#include "i2b/quality/glances.h"
#include "i2b/quality/measures.h"
#include "i2b/quality/tally.h"
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <numbers>

namespace i2b {
namespace {

using Index = std::size_t;
constexpr double flat = 1e-9; // a pyramid below this part of its cell's size counts as wrong
constexpr double doubtful = 20 * undividedShare; // of tetrahedra: up to there their quality is looked at
constexpr double clearShare = 2 * undividedShare; // of tetrahedra: faces that a glance finds over that need no look
constexpr Index together = 32; // cells that a thread measures anew in a row
constexpr double mostThin = 0.05; // faces for each thin cell that may have a fault of one kind for it to count
constexpr double mostThinner = 0.002; // the same of faces that do not divide, where
constexpr double lackingShare = 0.05; // so many of the thin cells are so thin that their determinants are under the limit;
constexpr Index sampled = 16;         // of so many one is asked

bool isBad(const PolyMesh& mesh, std::span<const std::int32_t> faces, std::span<const FaceShape> shapes, std::int32_t cell,
           const CellMoments& moments) {
    if (!(moments.volume > 0)) return true;
    for (Index i = 0; i < faces.size(); ++i) {
        const Vec3 arm = shapes[i].centre - moments.centre;
        const double sign = mesh.owner[Index(faces[i])] == cell ? 1 : -1;
        if (!(sign * dot(shapes[i].area, arm) > flat * norm(shapes[i].area) * norm(arm))) return true;
    }
    return false;
}

constexpr std::uint8_t beside = 1, within = 2; // a cell that has a point that may move, and one that shares a face with such a cell

// Per cell one of these, or 0; empty where all points may move.
std::vector<std::uint8_t> cellsAtMovable(const PolyMesh& mesh, const std::vector<std::uint8_t>& mayMove) {
    std::vector<std::uint8_t> near;
    if (mayMove.empty()) return near;
    near.assign(Index(mesh.cells), 0);
    const auto raise = [&](std::int32_t cell, std::uint8_t to) { std::atomic_ref(near[Index(cell)]).store(to, std::memory_order_relaxed); };
    const auto isWithin = [&](std::int32_t cell) { return std::atomic_ref(near[Index(cell)]).load(std::memory_order_relaxed) == within; };
    const Index internal = mesh.neighbour.size();
    parallelFor(Index(mesh.faces()), [&](Index f) {
        const auto v = mesh.face(static_cast<std::int32_t>(f));
        if (std::ranges::none_of(v, [&](std::int32_t p) { return mayMove[Index(p)] != 0; })) return;
        raise(mesh.owner[f], within);
        if (f < internal) raise(mesh.neighbour[f], within);
    }, 4096);
    parallelFor(internal, [&](Index f) {
        const std::int32_t own = mesh.owner[f], next = mesh.neighbour[f];
        if (isWithin(own) == isWithin(next)) return;
        raise(isWithin(own) ? next : own, beside);
    }, 4096);
    return near;
}

} // namespace

MeshFaults::MeshFaults(const PolyMesh& mesh, const Rows& cellFaces, const QualityLimits& limits, std::int32_t thinFrom, const std::vector<std::uint8_t>& mayMove)
    : mesh_(mesh), cellFaces_(cellFaces), limits_(limits), thinFrom_(thinFrom),
      severeCosine_(std::cos(limits.nonOrthogonality * std::numbers::pi / 180)), tets_(limits.tetQuality), moments_(Index(mesh.cells)),
      cellFlags_(Index(mesh.cells)), faceFlags_(Index(mesh.faces())), moved_(mesh.points.size(), 0),
      changed_(Index(mesh.cells), 0) {
    const std::vector<std::uint8_t> near = cellsAtMovable(mesh, mayMove);
    measureCells(near);
    measureFaces(near);
    lookAtThin();
}

// Where a glance finds every face's centre clearly behind all others' planes, the cell's own centre is behind them by
// over 1/24 of that cosine (planarCosine), so that no pyramid is next to nothing.
void MeshFaults::measureCells(const std::vector<std::uint8_t>& near) {
    HexBounds thick = openHexBounds;
    thick.determinant = limits_.determinant;
    parallelChunks(moments_.size(), 2048, [&](Index begin, Index end, Index) {
        CellFaceShapes shapes(mesh_);
        HexGlance hexes(mesh_, cellFaces_, thick), thinHexes(mesh_, cellFaces_, openHexBounds);
        const auto closely = [&](std::int32_t cell) { measureCellAt(cell, shapes); };
        const auto clear = [&](std::int32_t cell, const HexBatch&, Index lane) {
            moments_[Index(cell)] = (cell < thinFrom_ ? hexes : thinHexes).moments(lane);
        };
        for (Index c = begin; c < end; ++c) {
            if (!near.empty() && near[c] == 0) continue;
            const auto cell = static_cast<std::int32_t>(c);
            if (!hexes.isHex(cellFaces_[cell])) closely(cell);
            else (cell < thinFrom_ ? hexes : thinHexes).add(cell, clear, closely);
        }
        hexes.finish(clear, closely), thinHexes.finish(clear, closely);
    });
}

// With S the least of V^2 / L^6, V six times the volume of a tetrahedron and L twice the reach from the face's
// centre to its vertices and the cells' centres, no height is under 2 sqrt(S) of the apex's own, and no width under 4 sqrt(S)
// but for its scale: over S = (share / 2)^2 tetShare() is over that share where no corner is reflex and the twist has as much to
// spare; and the quality of tetrahedra, which goes with S squared, is far over 1e-15.
void MeshFaults::measureFaces(const std::vector<std::uint8_t>& near) {
    constexpr double margin = 1.01;
    QuadBounds bounds = openQuadBounds;
    bounds.cosine = severeCosine_, bounds.weight = limits_.faceWeight, bounds.ratio = limits_.volumeRatio;
    bounds.skewness = std::min(limits_.skewness, limits_.boundarySkewness);
    bounds.pyramid3 = std::max(0.0, 3 * limits_.pyramidVolume * margin);
    bounds.tetShape = margin * clearShare * clearShare / 4;
    bounds.twist = leastTwist + clearShare;
    parallelChunks(faceFlags_.size(), 4096, [&](Index begin, Index end, Index) {
        QuadGlance quads(mesh_, moments_.data(), bounds);
        const auto closely = [&](Index f) { measureFaceAt(static_cast<std::int32_t>(f)); };
        const auto clear = [](Index, const QuadBatch&, Index) {};
        const auto isNear = [&](Index f) {
            return near.empty() || near[Index(mesh_.owner[f])] == within || (f < mesh_.neighbour.size() && near[Index(mesh_.neighbour[f])] == within);
        };
        for (Index f = begin; f < end; ++f)
            if (isNear(f) && !quads.add(f, clear, closely)) closely(f);
        quads.finish(clear, closely);
    });
}

// What only some of the thin cells have can be mended; what many have goes with their height.
void MeshFaults::lookAtThin() {
    if (thinFrom_ >= mesh_.cells) return;
    std::array<Index, 2> found{};
    faceFlags_.forEach([&](Index f) {
        if (mesh_.owner[f] < thinFrom_) return; // the other side is the higher number
        found[0] += (faceFlags_[f] & (lowWeight | lowRatio)) != 0;
        found[1] += (faceFlags_[f] & undivided) != 0;
    });
    const auto areOver = [&](Index faces, double most) { return static_cast<double>(faces) > most * (mesh_.cells - thinFrom_); };
    if (areOver(found[0], mostThin)) thinFlags_ &= ~(lowWeight | lowRatio);
    if (areOver(found[1], mostThin) || (areOver(found[1], mostThinner) && thinLackDeterminants())) thinFlags_ &= ~undivided;
}

// Are thin cells so thin that they are beyond the limit of determinants for their height alone?
bool MeshFaults::thinLackDeterminants() const {
    const Index n = (Index(mesh_.cells - thinFrom_) + sampled - 1) / sampled;
    const auto count = [&](Index begin, Index end) {
        CellFaceShapes shapes(mesh_);
        Index lacking = 0;
        for (Index i = begin; i < end; ++i)
            lacking += cellFullness(shapes.of(cellFaces_[thinFrom_ + static_cast<std::int32_t>(i * sampled)])) < limits_.determinant;
        return lacking;
    };
    const Index lacking = orderedReduce(n, Index(0), count, [](Index a, Index b) { return a + b; });
    return static_cast<double>(lacking) > lackingShare * static_cast<double>(n);
}

void MeshFaults::measureCellAt(std::int32_t cell, CellFaceShapes& faceShapes) {
    const std::span<const std::int32_t> faces = cellFaces_[cell];
    const std::span<const FaceShape> shapes = faceShapes.of(faces);
    CellMoments& moments = moments_[Index(cell)];
    moments = measureCell(mesh_, faces, shapes, cell);
    const bool low = cell < thinFrom_ && cellDeterminant(mesh_, faces, shapes, Directions()) < limits_.determinant;
    cellFlags_.set(Index(cell), static_cast<std::uint8_t>((isBad(mesh_, faces, shapes, cell, moments) ? bad : 0) | (low ? lowDeterminant : 0)));
}

void MeshFaults::measureFaceAt(std::int32_t face) {
    const FaceShape shape = measureFace(mesh_, face);
    const CellMoments& own = moments_[Index(mesh_.owner[Index(face)])];
    const Vec3* neighbour = nullptr;
    int flags = 0;
    if (face < mesh_.internalFaces()) {
        const CellMoments& nei = moments_[Index(mesh_.neighbour[Index(face)])];
        const PairValues values = pairValues(shape, own, nei);
        neighbour = &nei.centre;
        flags = (values.ortho < severeCosine_ ? nonOrthogonal : 0) | (values.weight < limits_.faceWeight ? lowWeight : 0) |
                (values.ratio < limits_.volumeRatio ? lowRatio : 0);
    }
    const double mostSkew = neighbour ? limits_.skewness : std::min(limits_.skewness, limits_.boundarySkewness);
    if (faceSkewness(mesh_, face, shape, own.centre, neighbour, mostSkew) > mostSkew) flags |= skew;
    const double share = tetShare(mesh_, face, shape.centre, shape.area, own.centre, neighbour, doubtful);
    // Two things that are each well enough may leave tetrahedra of no quality; of a triangle tetShare() knows its width alone.
    const auto isPoor = [&] {
        return limits_.tetQuality > 0 && (share < doubtful || mesh_.face(face).size() == 3) && tetErrors(mesh_, mesh_.face(face), shape.centre, own.centre, neighbour, tets_) > 0;
    };
    if (share < undividedShare || pyramidShare(shape, own.centre, neighbour, limits_.pyramidVolume) < 0 || isPoor()) flags |= undivided;
    faceFlags_.set(Index(face), static_cast<std::uint8_t>(flags));
}

bool MeshFaults::hasMoved(std::int32_t face) const {
    const auto v = mesh_.face(face);
    return std::any_of(v.begin(), v.end(), [&](std::int32_t p) { return moved_[Index(p)] != 0; });
}

// All cells that use a moved point. The cells at a point hang together through faces at the point, so all of them are
// found from one.
std::vector<std::int32_t> MeshFaults::cellsAround(const std::vector<std::int32_t>& seeds) {
    std::vector<std::int32_t> cells;
    const auto add = [&](std::int32_t cell) {
        if (changed_[Index(cell)]) return;
        changed_[Index(cell)] = 1;
        cells.push_back(cell);
    };
    const auto addAll = [&](const RawVector<std::int32_t>& found) { std::ranges::for_each(found, add); };
    addAll(collect<std::int32_t>(seeds.size(), [&](Index i, const auto& put) {
        const auto faces = cellFaces_[seeds[i]];
        if (std::any_of(faces.begin(), faces.end(), [&](std::int32_t f) { return hasMoved(f); })) put(seeds[i]);
    }, 512));
    for (Index first = 0; first < cells.size();) {
        const Index last = cells.size();
        addAll(collect<std::int32_t>(last - first, [&](Index i, const auto& put) {
            for (const std::int32_t f : cellFaces_[cells[first + i]]) {
                if (f >= mesh_.internalFaces() || !hasMoved(f)) continue;
                const std::int32_t own = mesh_.owner[Index(f)], other = own == cells[first + i] ? mesh_.neighbour[Index(f)] : own;
                if (!changed_[Index(other)]) put(other);
            }
        }, 512));
        first = last;
    }
    return cells;
}

void MeshFaults::update(const std::vector<std::int32_t>& movedPoints, const std::vector<std::int32_t>& seeds) {
    for (const std::int32_t p : movedPoints) moved_[Index(p)] = 1;
    std::vector<std::int32_t> cells = cellsAround(seeds);
    for (const std::int32_t c : cells) changed_[Index(c)] = 0;
    for (const std::int32_t p : movedPoints) moved_[Index(p)] = 0;
    update(cells);
}

void MeshFaults::follow(const std::vector<std::int32_t>& cells) {
    parallelChunks(cells.size(), together, [&](Index begin, Index end, Index) {
        CellFaceShapes shapes(mesh_);
        for (Index i = begin; i < end; ++i) {
            const auto faces = cellFaces_[cells[i]];
            moments_[Index(cells[i])] = measureCell(mesh_, faces, shapes.of(faces), cells[i]);
        }
    });
}

void MeshFaults::update(const std::vector<std::int32_t>& cells) {
    for (const std::int32_t c : cells) changed_[Index(c)] = 1;
    parallelChunks(cells.size(), together, [&](Index begin, Index end, Index) {
        CellFaceShapes shapes(mesh_);
        for (Index i = begin; i < end; ++i) measureCellAt(cells[i], shapes);
    });
    parallelFor(cells.size(), [&](Index i) {
        for (const std::int32_t f : cellFaces_[cells[i]]) {
            const std::int32_t owner = mesh_.owner[Index(f)];
            if (owner == cells[i] || !changed_[Index(owner)]) measureFaceAt(f); // each face by one of its cells
        }
    }, together);
    for (const std::int32_t c : cells) changed_[Index(c)] = 0;
}

std::vector<std::int32_t> MeshFaults::badCells() const {
    std::vector<std::int32_t> cells;
    cellFlags_.forEach([&](Index c) {
        if (cellFlags_[c] & bad) cells.push_back(static_cast<std::int32_t>(c));
    });
    return cells;
}

std::vector<std::int32_t> MeshFaults::poorCells(FaultCount& faults, bool severeOnly) const {
    constexpr std::array<std::uint8_t, 4> ofFaces{nonOrthogonal, skew, lowWeight, lowRatio};
    constexpr Index severeKinds = 2;
    // One poor column of thin layers has as many poor faces as layers: all are named.
    const Index limit = thinFrom_ < mesh_.cells ? std::numeric_limits<Index>::max() : Tally::idLimit;
    std::array<Index, 4> found{};
    Index determinants = 0;
    std::vector<std::int32_t> cells;
    faceFlags_.forEach([&](Index f) {
        const int flags = flagsOf(f) & ~undivided;
        bool named = false;
        for (Index k = 0; k < ofFaces.size(); ++k)
            if (flags & ofFaces[k]) named |= found[k]++ < limit && (k < severeKinds || !severeOnly);
        if (!named) return;
        cells.push_back(mesh_.owner[f]);
        if (f < mesh_.neighbour.size()) cells.push_back(mesh_.neighbour[f]);
    });
    cellFlags_.forEach([&](Index c) {
        if ((cellFlags_[c] & lowDeterminant) && determinants++ < limit && !severeOnly) cells.push_back(static_cast<std::int32_t>(c));
    });
    faults.severe = static_cast<std::int64_t>(found[0] + found[1]);
    faults.all = static_cast<std::int64_t>(determinants);
    for (const Index n : found) faults.all += static_cast<std::int64_t>(n);
    std::sort(cells.begin(), cells.end());
    cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
    return cells;
}

std::vector<std::int32_t> MeshFaults::undividedFaces() const {
    std::vector<std::int32_t> faces;
    faceFlags_.forEach([&](Index f) {
        if (flagsOf(f) & undivided) faces.push_back(static_cast<std::int32_t>(f));
    });
    return faces;
}

std::vector<std::int32_t> MeshFaults::poorFaces() const {
    std::vector<std::int32_t> faces;
    faceFlags_.forEach([&](Index f) {
        if (flagsOf(f) != 0) faces.push_back(static_cast<std::int32_t>(f));
    });
    cellFlags_.forEach([&](Index c) {
        const auto row = cellFaces_[static_cast<std::int32_t>(c)];
        faces.insert(faces.end(), row.begin(), row.end());
    });
    std::sort(faces.begin(), faces.end());
    faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
    return faces;
}

} // namespace i2b
