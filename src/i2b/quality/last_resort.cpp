#include "i2b/quality/last_resort.h"
#include "i2b/quality/poor_places.h"
#include "i2b/quality/local_edits.h"
#include "i2b/quality/dictionary_measure.h"
#include "i2b/quality/measure_steps.h"
#include <algorithm>
#include <array>
#include <optional>

namespace i2b {
namespace {

using Index = std::size_t;
constexpr int mostRounds = 16, mostOrders = 4;
constexpr std::size_t fewFaces = 2000;  // to be helped: other orders are tried
constexpr std::size_t mostCells = 4;    // of a group
constexpr std::size_t mostThinCells = 16; // the same of layers in a column
constexpr std::size_t mostFlat = 200;    // thin cells of a small determinant
constexpr double stackedShare = 0.5;    // of the largest face of two cells, that they meet in
constexpr int mostConcave = 2;          // cells that a change may make concave: those beside a divided face

struct Verdict {
    std::array<std::int64_t, dictionaryLimitCount + 10> counts{}; // of everything that a check names
    std::int64_t faces = 0, concave = 0;                         // faces beyond limits, cells
};

Verdict judge(const PolyMesh& mesh, const DictionaryLimits& dictionary) {
    const QualityLimits limits;
    Measurement m{mesh, limits, dictionary, {}, {}, {}, {}, {}, {}, {}};
    for (const Vec3& p : mesh.points) m.report.box.add(p);
    m.cellFaces = buildCellFaces(mesh);
    measureCells(m);
    measureFaces(m);
    measureFaceFaces(m, buildPointFaces(mesh));
    const QualityReport& r = m.report;
    Verdict v;
    Index n = 0;
    for (const DictionaryCheck& check : r.dictionary) v.counts[n++] = check.faces;
    for (const std::int64_t count : {r.negativeVolumeCells, r.openCells, r.wrongOrientedFaces, r.highlySkewFaces, r.smallDeterminantCells,
                                     r.lowWeightFaces, r.lowVolumeRatioFaces, r.highAspectRatioCells, r.tetErrors, r.duplicateFaces})
        v.counts[n++] = count;
    v.faces = r.dictionaryFaces, v.concave = r.concaveCells;
    return v;
}

bool isBetter(const Verdict& now, const Verdict& before) {
    for (Index i = 0; i < now.counts.size(); ++i)
        if (now.counts[i] > before.counts[i]) return false;
    return now.faces < before.faces && now.concave <= before.concave + mostConcave;
}

using Trial = LocalEdits::Trial;

// Two groups, or one, as they are.
Trial still(std::int32_t a, std::int32_t b) {
    if (a == b) return {{a}};
    return {{std::min(a, b), std::max(a, b)}};
}

class Changer {
  public:
    Changer(const PolyMesh& mesh, const LocalEdits& edits, const DictionaryLimits& limits, std::int32_t thinFrom)
        : mesh_(mesh), edits_(edits), limits_(limits), thinFrom_(thinFrom) {}

    // What helps a face with the least change: dividing it, uniting its own two cells, else one of them with the neighbour
    // across its largest face.
    std::optional<Trial> find(std::int32_t face) const {
        const std::int32_t own = edits_.of(mesh_.owner[Index(face)]), other = edits_.across(face, own);
        if (own == other) return {};
        const Verdict now = judge(edits_.around(still(own, other < 0 ? own : other)), limits_);
        if (now.faces == 0) return {};
        if (const auto divided = divide(face, own, other, now)) return divided;
        if (other >= 0)
            if (const auto united = unite(own, other)) return united;
        for (const std::int32_t group : {own, other}) {
            if (group < 0) continue;
            for (const std::int32_t next : byFace(group)) {
                if (next == own || next == other) continue;
                if (const auto united = unite(group, next)) return united;
            }
        }
        for (const std::int32_t group : {own, other}) {
            if (group < thinFrom_) continue;
            if (const auto united = uniteColumn(group)) return united;
        }
        return {};
    }

  private:
    std::vector<std::int32_t> byFace(std::int32_t group) const { // neighbours, the one across the largest face first
        std::vector<std::int32_t> faces;
        edits_.facesOf(group, faces);
        std::vector<std::pair<double, std::int32_t>> sizes;
        for (const std::int32_t f : faces)
            if (const std::int32_t next = edits_.across(f, group); next >= 0) sizes.emplace_back(-norm2(measureFace(mesh_, f).area), next);
        std::sort(sizes.begin(), sizes.end());
        std::vector<std::int32_t> neighbours;
        for (const auto& [size, next] : sizes) neighbours.push_back(next);
        return neighbours;
    }
    bool mayUnite(std::int32_t a, std::int32_t b) const {
        const bool areThin = a >= thinFrom_ && b >= thinFrom_;
        if (!mesh_.cellRegion.empty() && mesh_.cellRegion[Index(a)] != mesh_.cellRegion[Index(b)]) return false;
        if (edits_.cells(a).size() + edits_.cells(b).size() > (areThin ? mostThinCells : mostCells) || !edits_.meetInOneFace(a, b)) return false;
        return !areThin || areStacked(a, b);
    }
    // Of thin cells only those of one column become one, else layers would end at others: these meet in what is among the largest faces
    // of both.
    bool areStacked(std::int32_t a, std::int32_t b) const {
        double shared2 = 0, largest2 = 0;
        std::vector<std::int32_t> faces;
        for (const std::int32_t group : {a, b}) {
            faces.clear();
            edits_.facesOf(group, faces);
            for (const std::int32_t f : faces) {
                const double size2 = norm2(measureFace(mesh_, f).area);
                largest2 = std::max(largest2, size2);
                if (edits_.across(f, group) == (group == a ? b : a)) shared2 = size2;
            }
        }
        return shared2 > stackedShare * stackedShare * largest2;
    }
    std::optional<Trial> unite(std::int32_t a, std::int32_t b) const {
        if (!mayUnite(a, b)) return {};
        return uniteAll({a, b});
    }
    std::optional<Trial> uniteAll(std::vector<std::int32_t> groups) const {
        std::sort(groups.begin(), groups.end());
        const Trial trial{std::move(groups), true};
        const Verdict before = judge(edits_.around({trial.groups}), limits_);
        if (before.faces > 0 && isBetter(judge(edits_.around(trial), limits_), before)) return trial;
        return {};
    }
    // The layers of the column that a thin group is of, from one end to the other: each meets the next ones only.
    std::vector<std::int32_t> columnOf(std::int32_t group) const {
        std::vector<std::int32_t> column{group};
        const auto isNext = [&](std::int32_t n) {
            const auto farther = [&](std::int32_t c) { return c == column.back() || (c != n && edits_.shareNoPoint(c, n)); };
            return n >= thinFrom_ && mayUnite(column.back(), n) && std::ranges::all_of(column, farther);
        };
        const auto extend = [&] {
            while (column.size() < mostThinCells) {
                const std::vector<std::int32_t> next = byFace(column.back());
                const auto at = std::ranges::find_if(next, isNext);
                if (at == next.end()) return;
                column.push_back(*at);
            }
        };
        extend();
        std::reverse(column.begin(), column.end());
        extend();
        return column;
    }
    // Some layers of a column as one, as few as help, this group among them.
    std::optional<Trial> uniteColumn(std::int32_t group) const {
        const std::vector<std::int32_t> column = columnOf(group);
        const auto own = static_cast<Index>(std::ranges::find(column, group) - column.begin());
        for (Index length = 3; length <= column.size(); ++length) {
            for (Index first = own + 1 < length ? 0 : own + 1 - length; first <= own && first + length <= column.size(); ++first) {
                const auto from = column.begin() + static_cast<std::ptrdiff_t>(first);
                if (const auto united = uniteAll({from, from + static_cast<std::ptrdiff_t>(length)})) return united;
            }
        }
        return {};
    }
    std::optional<Trial> divide(std::int32_t face, std::int32_t own, std::int32_t other, const Verdict& now) const {
        const auto corners = static_cast<std::uint32_t>(mesh_.face(face).size());
        if (corners < 4 || edits_.isDivided(face)) return {};
        if (other < 0) other = own;
        Trial trial = still(own, other);
        Verdict least = now;
        std::optional<Trial> best;
        trial.face = face;
        for (; trial.from < (corners == 4 ? 2 : corners); ++trial.from) { // a quadrangle has two diagonals
            const Verdict v = judge(edits_.around(trial), limits_);
            if (isBetter(v, least)) least = v, best = trial;
        }
        return best;
    }

    const PolyMesh& mesh_;
    const LocalEdits& edits_;
    const DictionaryLimits& limits_;
    std::int32_t thinFrom_;
};

// Makes those of the changes that do not touch what an earlier one has changed; returns the groups around them, ascending.
// made: of each change whether it was.
std::vector<std::int32_t> make(const std::vector<std::optional<Trial>>& changes, LocalEdits& edits, std::vector<std::uint8_t>& made) {
    std::vector<std::int32_t> touched;
    made.assign(changes.size(), 0);
    for (Index i = 0; i < changes.size(); ++i) {
        const std::optional<Trial>& change = changes[i];
        if (!change) continue;
        const std::vector<std::int32_t> around = edits.neighboursOf(change->groups);
        if (std::ranges::any_of(around, [&](std::int32_t g) { return std::ranges::binary_search(touched, g); })) continue;
        if (change->united)
            for (Index k = 1; k < change->groups.size(); ++k) edits.unite(change->groups.front(), change->groups[k]);
        else edits.divide(change->face, change->from);
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
    for (const auto& [face, from] : edits.fans) {
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
        left[i] = !isGone && judge(edits.around(still(own, other)), limits).faces > 0;
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
        const bool isLast = next.size() == first.size();
        first = std::move(next);
        if (!best || now.left.size() < best->left.size()) best.emplace(std::move(now));
        if (isLast) break;
    }
    return std::move(*best);
}

} // namespace

std::vector<std::int32_t> facesBeyondHelp(const PolyMesh& mesh, const Rows& cellFaces, const std::vector<std::int32_t>& poorFaces,
                                          const DictionaryLimits& limits, std::int32_t thinFrom) {
    LocalEdits edits(mesh, cellFaces);
    seekChanges(mesh, poorFaces, limits, thinFrom, edits, nullptr);
    return facesLeft(mesh, poorFaces, limits, edits);
}

LastResort changePoorPlaces(PolyMesh& mesh, const std::vector<std::int32_t>& poorFaces, const DictionaryLimits& limits, std::int32_t thinFrom) {
    LastResort summary;
    std::vector<std::int32_t> faces, concave;
    // MeshFaults names those that the default limit forbids, but for thin cells that have many.
    const bool areNamed = limits.concavity >= DictionaryLimits().concavity && thinFrom >= mesh.cells;
    if (DictionaryBounds(limits).concavityAsked && !areNamed) concave = concaveFaces(mesh, limits.concavity);
    std::ranges::set_union(poorFaces, concave, std::back_inserter(faces));
    const bool flatAsked = thinFrom < mesh.cells && DictionaryBounds(limits).determinant > 0;
    if (faces.empty() && !flatAsked) return summary;
    const Rows cellFaces = buildCellFaces(mesh);
    if (flatAsked) {
        const std::vector<std::int32_t> poor = std::move(faces);
        faces.clear();
        std::ranges::set_union(poor, facesOfFlatCells(mesh, cellFaces, thinFrom, limits.determinant, mostFlat), std::back_inserter(faces));
    }
    if (faces.empty()) return summary;
    Edited edited = seekInOrders(mesh, cellFaces, faces, limits, thinFrom);
    const LocalEdits& edits = edited.edits;
    summary.changes.places = std::move(edited.places);
    summary.changes.merged = edits.united(), summary.changes.divided = edits.divided();
    if (summary.changes.merged + summary.changes.divided == 0) return summary;
    const MeshEdits all = edits.edits();
    summary.morePieces = piecesOfWalls(mesh, all);
    summary.cellOf = editMesh(mesh, all);
    return summary;
}

} // namespace i2b
