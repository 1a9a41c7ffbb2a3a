#include "i2b/edit/last_resort.h"
#include "i2b/core/parallel.h"
#include "i2b/edit/changer.h"
#include "i2b/edit/poor_places.h"
#include "i2b/quality/tally.h"
#include <algorithm>
#include <optional>

namespace i2b {
namespace {

using Index = std::size_t;
constexpr int mostRounds = 16, mostOrders = 4;
constexpr std::size_t fewFaces = 2000;  // to be helped: other orders are tried
constexpr std::size_t fewFirst = 200;   // that come first in these
constexpr std::size_t fewLeft = 4;      // that nothing has helped, or beside one: pairs of changes are tried

using Trial = LocalEdits::Trial;

// Makes those of the changes that do not touch what an earlier one has changed; returns the groups around them, ascending.
// made: of each change whether it was.
std::vector<std::int32_t> make(const std::vector<std::optional<Trial>>& changes, LocalEdits& edits, std::vector<std::uint8_t>& made) {
    std::vector<std::int32_t> touched;
    made.assign(changes.size(), 0);
    for (Index i = 0; i < changes.size(); ++i) {
        const std::optional<Trial>& change = changes[i];
        if (!change) continue;
        // All that it was judged by is as it was where none of its groups is beside one that has changed.
        if (std::ranges::any_of(change->groups, [&](std::int32_t g) { return std::ranges::binary_search(touched, g); })) continue;
        const std::vector<std::int32_t> around = edits.neighboursOf(change->groups);
        apply(*change, edits);
        made[i] = 1;
        const auto middle = static_cast<std::ptrdiff_t>(touched.size());
        touched.insert(touched.end(), around.begin(), around.end());
        std::inplace_merge(touched.begin(), touched.begin() + middle, touched.end());
    }
    return touched;
}

// Per face that dividing adds to walls, the cell there; ascending.
std::vector<std::int32_t> piecesOfWalls(const PolyMesh& mesh, const MeshEdits& edits) {
    std::vector<std::int32_t> cells;
    for (const auto& [face, from] : edits.divided) {
        for (const Patch& patch : mesh.patches)
            if (patch.type == "wall" && face >= patch.start && face < patch.start + patch.count)
                cells.insert(cells.end(), mesh.face(face).size() - 3, mesh.owner[Index(face)]);
    }
    std::sort(cells.begin(), cells.end());
    return cells;
}

// Tries and makes changes for the faces; places: of those that were to be mended (may be null).
void seekChanges(const PolyMesh& mesh, std::vector<std::int32_t> faces, const DictionaryLimits& limits, std::int32_t thinFrom, LocalEdits& edits,
                 std::vector<Vec3>* places) {
    for (int round = 0; round < mostRounds && !faces.empty(); ++round) {
        const Changer changer(mesh, edits, limits, thinFrom);
        std::vector<std::optional<Trial>> changes(faces.size());
        std::vector<std::uint8_t> made;
        parallelFor(faces.size(), [&](Index i) { changes[i] = changer.find(faces[i]); }, 1);
        const std::vector<std::int32_t> touched = make(changes, edits, made);
        if (touched.empty()) break;
        for (Index i = 0; places && i < faces.size(); ++i)
            if (made[i] && places->size() < Tally::idLimit) places->push_back(measureFace(mesh, faces[i]).centre);
        const auto isTouched = [&](std::int32_t group) { return std::ranges::binary_search(touched, group); };
        Index left = 0;
        for (Index i = 0; i < faces.size(); ++i) { // that may yet be helped: by a change that had to wait, or where all is new
            const std::int32_t own = edits.of(mesh.owner[Index(faces[i])]), other = edits.across(faces[i], own);
            if (own != other && (changes[i] || isTouched(own) || isTouched(other))) faces[left++] = faces[i];
        }
        faces.resize(left);
    }
}

// Of the faces, ascending, those that are still beyond limits, or beside one that is.
std::vector<std::int32_t> facesLeft(const PolyMesh& mesh, const std::vector<std::int32_t>& poorFaces, const DictionaryLimits& limits,
                                    const LocalEdits& edits) {
    std::vector<std::uint8_t> left(poorFaces.size(), 0);
    parallelFor(left.size(), [&](Index i) {
        const std::int32_t face = poorFaces[i], own = edits.of(mesh.owner[Index(face)]);
        const std::int32_t across = edits.across(face, own), other = across < 0 ? own : across;
        const bool isGone = across == own; // inside a merged cell
        left[i] = !isGone && anyBeyond(edits.around(still(own, other)), limits);
    }, 1);
    std::vector<std::int32_t> faces;
    for (Index i = 0; i < left.size(); ++i)
        if (left[i]) faces.push_back(poorFaces[i]);
    return faces;
}

struct Edited {
    LocalEdits edits;
    std::vector<Vec3> places;
    std::vector<std::int32_t> left; // faces that nothing has helped
};

// A change may be in the way of what would help another face: where few are left, all is done anew with these first.
Edited seekInOrders(const PolyMesh& mesh, const Rows& cellFaces, const std::vector<std::int32_t>& faces, const DictionaryLimits& limits,
                    std::int32_t thinFrom) {
    std::optional<Edited> best;
    std::vector<std::int32_t> first;
    for (int order = 0; order < mostOrders; ++order) {
        Edited now{LocalEdits(mesh, cellFaces), {}, {}};
        seekChanges(mesh, first, limits, thinFrom, now.edits, &now.places);
        seekChanges(mesh, faces, limits, thinFrom, now.edits, &now.places);
        if (faces.size() <= fewFaces) now.left = facesLeft(mesh, faces, limits, now.edits);
        std::vector<std::int32_t> next;
        std::ranges::set_union(first, now.left, std::back_inserter(next));
        const bool isLast = next.size() == first.size() || next.size() > fewFirst;
        first = std::move(next);
        if (!best || now.left.size() < best->left.size()) best.emplace(std::move(now));
        if (isLast) break;
    }
    return std::move(*best);
}

// Where single changes help none of a few faces, two at once may.
void seekPairs(const PolyMesh& mesh, const DictionaryLimits& limits, std::int32_t thinFrom, Edited& edited) {
    if (edited.left.size() > fewLeft) return;
    for (const std::int32_t face : edited.left) {
        const auto pair = findPair(mesh, face, limits, thinFrom, edited.edits);
        if (!pair) continue;
        for (const Trial& change : *pair) apply(change, edited.edits);
        if (edited.places.size() < Tally::idLimit) edited.places.push_back(measureFace(mesh, face).centre);
    }
}

} // namespace

std::vector<std::int32_t> facesBeyondHelp(const PolyMesh& mesh, const Rows& cellFaces, const std::vector<std::int32_t>& poorFaces,
                                          const DictionaryLimits& limits, std::int32_t thinFrom) {
    LocalEdits edits(mesh, cellFaces);
    seekChanges(mesh, poorFaces, limits, thinFrom, edits, nullptr);
    return facesLeft(mesh, poorFaces, limits, edits);
}

LastResort changePoorPlaces(PolyMesh& mesh, Rows cellFaces, const std::vector<std::int32_t>& poorFaces, const DictionaryLimits& limits, std::int32_t thinFrom) {
    LastResort summary;
    std::vector<std::int32_t> faces, concave;
    // MeshFaults names those that the default limit forbids, but for thin cells that have many.
    const bool areNamed = limits.concavity >= DictionaryLimits().concavity && thinFrom >= mesh.cells;
    if (DictionaryBounds(limits).concavityAsked && !areNamed) concave = concaveFaces(mesh, limits.concavity);
    std::ranges::set_union(poorFaces, concave, std::back_inserter(faces));
    const bool flatAsked = thinFrom < mesh.cells && DictionaryBounds(limits).determinant > 0;
    if (faces.empty() && !flatAsked) return summary;
    if (flatAsked) {
        const std::vector<std::int32_t> poor = std::move(faces);
        const std::vector<std::int32_t> flat = facesOfFlatCells(mesh, cellFaces, thinFrom, limits.determinant).value_or(std::vector<std::int32_t>());
        faces.clear();
        std::ranges::set_union(poor, flat, std::back_inserter(faces));
    }
    if (faces.empty()) return summary;
    Edited edited = seekInOrders(mesh, cellFaces, faces, limits, thinFrom);
    seekPairs(mesh, limits, thinFrom, edited);
    const LocalEdits& edits = edited.edits;
    summary.changes.places = std::move(edited.places);
    summary.changes.merged = edits.united(), summary.changes.divided = edits.divided();
    if (summary.changes.merged + summary.changes.divided == 0) return summary;
    const MeshEdits all = edits.edits();
    summary.morePieces = piecesOfWalls(mesh, all);
    cellFaces = {}; // room for the arrays that take the place of the mesh's
    summary.cellOf = editMesh(mesh, all);
    return summary;
}

} // namespace i2b
