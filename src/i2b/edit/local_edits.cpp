#include "i2b/edit/local_edits.h"
#include "i2b/core/numbering.h"
#include "i2b/core/sort_unique.h"
#include <algorithm>
#include <array>
#include <numeric>

namespace i2b {
namespace {

using Index = std::size_t;

// A mesh that faces are put into one by one.
class MeshBuilder {
  public:
    MeshBuilder(const PolyMesh& from, const Numbering& points, std::int32_t cells) : from_(from), points_(points) {
        mesh_.cells = cells;
        for (const std::int32_t p : points.items()) mesh_.points.push_back(from.points[Index(p)]);
        mesh_.faceOffsets.push_back(0);
    }
    // Out of owner into neighbour, one of which may be -1. from: where it is divided.
    void add(std::int32_t face, std::int32_t owner, std::int32_t neighbour, const std::uint32_t* from) {
        const auto v = from_.face(face);
        const bool turned = neighbour < 0 ? false : owner < 0 || owner > neighbour;
        if (!from) return addLoop(v, owner, neighbour, turned);
        for (const auto& [a, b, c] : trianglesOf(from_.points, v, *from)) addLoop(std::array{v[a], v[b], v[c]}, owner, neighbour, turned);
    }
    Index faces() const { return mesh_.owner.size(); }
    PolyMesh take() {
        mesh_.patches = {{"rest", "patch", mesh_.internalFaces(), mesh_.faces() - mesh_.internalFaces()}};
        return std::move(mesh_);
    }

  private:
    void addLoop(std::span<const std::int32_t> loop, std::int32_t owner, std::int32_t neighbour, bool turned) {
        for (const std::int32_t p : loop) mesh_.faceVertices.push_back(points_.placeOf(p));
        if (turned) std::reverse(mesh_.faceVertices.end() - static_cast<std::ptrdiff_t>(loop.size()), mesh_.faceVertices.end());
        mesh_.faceOffsets.push_back(static_cast<std::uint32_t>(mesh_.faceVertices.size()));
        const bool inner = owner >= 0 && neighbour >= 0;
        mesh_.owner.push_back(inner ? std::min(owner, neighbour) : std::max(owner, neighbour));
        if (inner) mesh_.neighbour.push_back(std::max(owner, neighbour));
    }

    const PolyMesh& from_;
    const Numbering& points_;
    PolyMesh mesh_;
};

} // namespace

LocalEdits::LocalEdits(const PolyMesh& mesh, const Rows& cellFaces) : mesh_(mesh), cellFaces_(cellFaces), isGrouped_(Index(mesh.cells)) {}

LocalEdits::Cells LocalEdits::cells(std::int32_t group) const {
    return isGrouped_[Index(group)] ? Cells(members_.at(group)) : Cells(group);
}

MeshEdits LocalEdits::edits() const {
    MeshEdits edits{std::vector<std::int32_t>(Index(mesh_.cells)), {divided_.begin(), divided_.end()}};
    std::iota(edits.groups.begin(), edits.groups.end(), 0);
    for (const auto& [cell, group] : groupOf_) edits.groups[Index(cell)] = group;
    return edits;
}

void LocalEdits::unite(std::int32_t a, std::int32_t b) {
    if (b < a) std::swap(a, b);
    const Cells from = cells(b), to = cells(a);
    std::vector<std::int32_t> all(to.begin(), to.end());
    all.insert(all.end(), from.begin(), from.end());
    for (const std::int32_t c : all) groupOf_[c] = a, isGrouped_[Index(c)] = true;
    members_.erase(b);
    members_[a] = std::move(all);
    ++united_;
}

std::int32_t LocalEdits::across(std::int32_t face, std::int32_t group) const {
    if (face >= mesh_.internalFaces()) return -1;
    const std::int32_t own = of(mesh_.owner[Index(face)]);
    return own == group ? of(mesh_.neighbour[Index(face)]) : own;
}

void LocalEdits::facesOf(std::int32_t group, std::vector<std::int32_t>& faces) const {
    for (const std::int32_t c : cells(group)) {
        for (const std::int32_t f : cellFaces_[c])
            if (across(f, group) != group) faces.push_back(f);
    }
}

void LocalEdits::pointsOf(std::int32_t group, std::vector<std::int32_t>& points) const {
    std::vector<std::int32_t> faces;
    facesOf(group, faces);
    for (const std::int32_t f : faces) {
        const auto v = mesh_.face(f);
        points.insert(points.end(), v.begin(), v.end());
    }
    sortUnique(points);
}

bool LocalEdits::meetInOneFace(std::int32_t a, std::int32_t b) const {
    std::vector<std::int32_t> faces;
    facesOf(a, faces);
    std::erase_if(faces, [&](std::int32_t f) { return across(f, a) != b; });
    return faces.size() == 1 && sharedPoints(a, b) == mesh_.face(faces.front()).size();
}

bool LocalEdits::shareNoPoint(std::int32_t a, std::int32_t b) const { return sharedPoints(a, b) == 0; }

std::size_t LocalEdits::sharedPoints(std::int32_t a, std::int32_t b) const {
    std::vector<std::int32_t> own, other, shared;
    pointsOf(a, own), pointsOf(b, other);
    std::set_intersection(own.begin(), own.end(), other.begin(), other.end(), std::back_inserter(shared));
    return shared.size();
}

std::vector<std::int32_t> LocalEdits::neighboursOf(const std::vector<std::int32_t>& groups) const {
    std::vector<std::int32_t> all = groups, faces;
    for (const std::int32_t group : groups) {
        faces.clear();
        facesOf(group, faces);
        for (const std::int32_t f : faces)
            if (const std::int32_t other = across(f, group); other >= 0) all.push_back(other);
    }
    sortUnique(all);
    return all;
}

LocalEdits::Surroundings LocalEdits::around(const Trial& trial) const {
    const std::vector<std::int32_t> groups = neighboursOf(trial.groups);
    std::vector<std::int32_t> faces;
    for (const std::int32_t group : groups) facesOf(group, faces);
    sortUnique(faces);
    const auto isTaken = [&](std::int32_t group) { return group != trial.groups.front() && std::ranges::binary_search(trial.groups, group); };
    Numbering cells, points;
    for (const std::int32_t group : groups)
        if (!trial.united || !isTaken(group)) cells.add(group);
    cells.close();
    const auto cellOf = [&](std::int32_t cell) {
        const std::int32_t group = of(cell);
        return cells.placeOf(trial.united && isTaken(group) ? trial.groups.front() : group);
    };
    struct Sides { std::int32_t face, owner, neighbour; };
    std::vector<Sides> inner, outer;
    for (const std::int32_t f : faces) {
        const std::int32_t own = cellOf(mesh_.owner[Index(f)]), nei = f < mesh_.internalFaces() ? cellOf(mesh_.neighbour[Index(f)]) : -1;
        if (own == nei) continue;
        (own >= 0 && nei >= 0 ? inner : outer).push_back({f, own, nei});
        for (const std::int32_t p : mesh_.face(f)) points.add(p);
    }
    points.close();
    Surroundings result;
    for (const std::int32_t group : cells.items()) result.outerCells.push_back(!std::ranges::binary_search(trial.groups, group));
    MeshBuilder mesh(mesh_, points, static_cast<std::int32_t>(cells.items().size()));
    const auto isOuter = [&](std::int32_t cell) { return cell < 0 || result.outerCells[Index(cell)] != 0; };
    for (const auto& sides : {inner, outer}) {
        for (const Sides& s : sides) {
            const auto at = divided_.find(s.face);
            mesh.add(s.face, s.owner, s.neighbour, s.face == trial.face ? &trial.from : at != divided_.end() ? &at->second : nullptr);
            result.outerFaces.resize(mesh.faces(), isOuter(s.owner) && isOuter(s.neighbour));
        }
    }
    result.mesh = mesh.take();
    return result;
}

} // namespace i2b
