#include "i2b/edit/changer.h"
#include "i2b/core/parallel.h"
#include "i2b/core/sort_unique.h"
#include "i2b/quality/measure_steps.h"
#include <algorithm>
#include <cmath>

namespace i2b {
namespace {

using Index = std::size_t;
constexpr std::size_t mostCells = 4;     // of a group
constexpr std::size_t mostStacked = 16;  // the same of flat ones on each other, as layers in a column are
constexpr double stackedShare = 0.5;     // of the largest face of two cells, that they meet in
constexpr std::int64_t mostNew = 1;      // faces beyond limits that the first of two changes may add
constexpr int mostConcave = 2;           // cells that a change may make concave: those beside a divided face
} // namespace

Verdict judge(const LocalEdits::Surroundings& around, const DictionaryLimits& dictionary) {
    const QualityLimits limits;
    const PolyMesh& mesh = around.mesh;
    Measurement m{mesh, limits, dictionary, {}, {}, {}, {}, {}, {}, {}, around.outerCells, around.outerFaces};
    for (const Vec3& p : mesh.points) m.report.box.add(p);
    m.cellFaces = buildCellFaces(mesh);
    measureCells(m);
    measureFaces(m);
    const QualityReport& r = m.report;
    Verdict v;
    Index n = 0;
    for (const DictionaryCheck& check : r.dictionary) v.counts[n++] = check.faces;
    for (const std::int64_t count : {r.negativeVolumeCells, r.openCells, r.wrongOrientedFaces, r.highlySkewFaces, r.smallDeterminantCells,
                                     r.lowWeightFaces, r.lowVolumeRatioFaces, r.highAspectRatioCells, r.tetErrors})
        v.counts[n++] = count;
    // checkMesh allows faces of a boundary no more skewness than others, the dictionary does.
    v.faces = r.dictionaryFaces + r.highlySkewFaces, v.concave = r.concaveCells;
    v.nonOrthogonality = r.maxNonOrthogonality, v.skewness = r.maxSkewness;
    return v;
}

bool anyBeyond(LocalEdits::Surroundings around, const DictionaryLimits& dictionary) {
    around.outerCells.clear(), around.outerFaces.clear();
    return judge(around, dictionary).faces > 0;
}

std::int64_t facesTwice(const PolyMesh& mesh) {
    const QualityLimits limits;
    const DictionaryLimits dictionary;
    Measurement m{mesh, limits, dictionary, {}, {}, {}, {}, {}, {}, {}};
    measureFaceFaces(m);
    return m.report.duplicateFaces;
}

bool hasNoMoreTwice(const PolyMesh& now, const PolyMesh& before) {
    const std::int64_t twice = facesTwice(now);
    return twice == 0 || twice <= facesTwice(before);
}

bool isBetter(const Verdict& now, const Verdict& before) {
    for (Index i = 0; i < now.counts.size(); ++i)
        if (now.counts[i] > before.counts[i]) return false;
    return now.faces < before.faces && now.concave <= before.concave + mostConcave;
}

bool isNoWorse(const Verdict& now, const Verdict& was, const DictionaryLimits& limits) {
    for (Index i = 0; i < now.counts.size(); ++i)
        if (now.counts[i] > was.counts[i]) return false;
    const DictionaryBounds bounds(limits);
    if (now.nonOrthogonality > std::max(was.nonOrthogonality, 0.9923 * limits.nonOrthogonality)) return false;
    if (now.skewness > std::max(was.skewness, 0.95 * std::min(bounds.internalSkewness, bounds.boundarySkewness))) return false;
    return now.faces <= was.faces && now.concave <= was.concave;
}

LocalEdits::Trial still(std::int32_t a, std::int32_t b) {
    if (a == b) return {{a}};
    return {{std::min(a, b), std::max(a, b)}};
}

void apply(const LocalEdits::Trial& change, LocalEdits& edits) {
    if (!change.united) return edits.divide(change.face, change.from);
    for (Index k = 1; k < change.groups.size(); ++k) edits.unite(change.groups.front(), change.groups[k]);
}

std::optional<LocalEdits::Trial> Changer::find(std::int32_t face) const {
    if (const auto small = findSmall(face)) return small;
    const std::int32_t own = edits_.of(mesh_.owner[Index(face)]), other = edits_.across(face, own);
    if (own == other || (own < thinFrom_ && other < thinFrom_)) return {};
    if (!anyBeyond(edits_.around(still(own, other < 0 ? own : other)), limits_)) return {};
    for (const std::int32_t group : {own, other}) {
        if (group < thinFrom_) continue;
        if (const auto united = uniteColumn(group)) return united;
    }
    return {};
}

std::optional<LocalEdits::Trial> Changer::findSmall(std::int32_t face) const {
    const std::int32_t own = edits_.of(mesh_.owner[Index(face)]), other = edits_.across(face, own);
    if (own == other) return {};
    const LocalEdits::Surroundings around = edits_.around(still(own, other < 0 ? own : other));
    const Verdict now = judge(around, limits_);
    if (now.faces == 0 && !anyBeyond(around, limits_)) return {};
    if (now.faces > 0)
        if (const auto divided = divide(face, around.mesh, now)) return divided;
    if (other >= 0)
        if (const auto united = unite(own, other)) return united;
    for (const std::int32_t group : {own, other}) {
        if (group < 0) continue;
        for (const std::int32_t next : byFace(group)) {
            if (next == own || next == other) continue;
            if (const auto united = unite(group, next)) return united;
        }
    }
    return {};
}

std::vector<std::int32_t> Changer::byFace(std::int32_t group) const {
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

bool Changer::mayUnite(std::int32_t a, std::int32_t b) const {
    const bool areThin = a >= thinFrom_ && b >= thinFrom_;
    const std::size_t cells = edits_.cells(a).size() + edits_.cells(b).size();
    if (!mesh_.cellRegion.empty() && mesh_.cellRegion[Index(a)] != mesh_.cellRegion[Index(b)]) return false;
    if (cells > mostStacked || !edits_.meetInOneFace(a, b)) return false;
    // Of thin cells only those of one column become one, else layers would end at others.
    if (cells <= mostCells && !areThin) return true;
    const Meeting m = meetingOf(a, b);
    return m.isLarge && (areThin || m.isWide);
}

Changer::Meeting Changer::meetingOf(std::int32_t a, std::int32_t b) const {
    double shared2 = 0, largest2 = 0, volume = 0;
    std::vector<std::int32_t> faces;
    for (const std::int32_t group : {a, b}) {
        faces.clear();
        edits_.facesOf(group, faces);
        for (const std::int32_t f : faces) {
            const FaceShape shape = measureFace(mesh_, f);
            const double size2 = norm2(shape.area), cone = dot(shape.area, shape.centre - mesh_.points[0]) / 3;
            largest2 = std::max(largest2, size2);
            volume += edits_.of(mesh_.owner[Index(f)]) == group ? cone : -cone;
            if (edits_.across(f, group) == (group == a ? b : a)) shared2 = size2;
        }
    }
    const double shared = std::sqrt(shared2);
    return {shared2 > stackedShare * stackedShare * largest2, volume <= shared * std::sqrt(shared)};
}

std::optional<LocalEdits::Trial> Changer::unite(std::int32_t a, std::int32_t b) const {
    if (!mayUnite(a, b)) return {};
    return uniteAll({a, b});
}

std::optional<LocalEdits::Trial> Changer::uniteAll(std::vector<std::int32_t> groups) const {
    std::sort(groups.begin(), groups.end());
    Trial trial{std::move(groups), true};
    const auto at = tried_.find(trial.groups);
    const bool does = at != tried_.end() ? at->second : helps(trial);
    if (at == tried_.end()) tried_.emplace(trial.groups, does);
    return does ? std::optional(std::move(trial)) : std::nullopt;
}

bool Changer::helps(const Trial& united) const {
    const LocalEdits::Surroundings was = edits_.around({united.groups});
    const Verdict before = judge(was, limits_);
    if (before.faces == 0) return false;
    const LocalEdits::Surroundings now = edits_.around(united);
    return isBetter(judge(now, limits_), before) && hasNoMoreTwice(now.mesh, was.mesh);
}

std::size_t Changer::HashGroups::operator()(const std::vector<std::int32_t>& groups) const {
    std::size_t sum = groups.size();
    for (const std::int32_t g : groups) sum = sum * 0x9e3779b97f4a7c15u + static_cast<std::size_t>(g);
    return sum ^ sum >> 32;
}

// The layers of the column that a thin group is of, from one end to the other: each meets the next ones only.
std::vector<std::int32_t> Changer::columnOf(std::int32_t group) const {
    std::vector<std::int32_t> column{group};
    const auto isNext = [&](std::int32_t n) {
        const auto farther = [&](std::int32_t c) { return c == column.back() || (c != n && edits_.shareNoPoint(c, n)); };
        return n >= thinFrom_ && mayUnite(column.back(), n) && std::ranges::all_of(column, farther);
    };
    const auto extend = [&] {
        while (column.size() < mostStacked) {
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
std::optional<LocalEdits::Trial> Changer::uniteColumn(std::int32_t group) const {
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

// Into the widest triangles, or a fan from each of its corners; a quadrangle has two diagonals.
std::vector<LocalEdits::Trial> Changer::divisionsOf(std::int32_t face) const {
    const auto corners = static_cast<std::uint32_t>(mesh_.face(face).size());
    if (corners < 4 || edits_.isDivided(face)) return {};
    const std::int32_t own = edits_.of(mesh_.owner[Index(face)]), other = edits_.across(face, own);
    Trial trial = still(own, other < 0 ? own : other);
    trial.face = face;
    std::vector<Trial> trials;
    if (corners > 4) {
        trials.push_back(trial);
        trials.back().from = widest;
    }
    for (; trial.from < (corners == 4 ? 2 : corners); ++trial.from) trials.push_back(trial);
    return trials;
}

std::optional<LocalEdits::Trial> Changer::divide(std::int32_t face, const PolyMesh& whole, const Verdict& before) const {
    Verdict least = before;
    std::optional<Trial> best;
    for (const Trial& trial : divisionsOf(face)) {
        const LocalEdits::Surroundings now = edits_.around(trial);
        const Verdict v = judge(now, limits_);
        if (isBetter(v, least) && hasNoMoreTwice(now.mesh, whole)) least = v, best = trial;
    }
    return best;
}

std::vector<LocalEdits::Trial> Changer::all(std::int32_t face) const {
    const std::int32_t own = edits_.of(mesh_.owner[Index(face)]), other = edits_.across(face, own);
    if (own == other) return {};
    std::vector<Trial> trials;
    std::vector<std::int32_t> faces;
    for (const std::int32_t group : {own, other}) {
        if (group < 0) continue;
        edits_.facesOf(group, faces);
        for (const std::int32_t next : byFace(group))
            if ((group == own || next != own) && mayUnite(group, next)) trials.push_back({{std::min(group, next), std::max(group, next)}, true});
    }
    sortUnique(faces);
    for (const std::int32_t f : faces) {
        const std::vector<Trial> divisions = divisionsOf(f);
        trials.insert(trials.end(), divisions.begin(), divisions.end());
    }
    return trials;
}

namespace {

// Of a second change after a first one that `then` holds: are both together better than neither?
bool areBetter(const LocalEdits& before, const LocalEdits& then, const LocalEdits::Trial& first, const LocalEdits::Trial& second,
               const DictionaryLimits& limits) {
    std::vector<std::int32_t> groups = first.groups, after;
    for (const std::int32_t g : second.groups)
        for (const std::int32_t c : then.cells(g)) groups.push_back(before.of(c));
    sortUnique(groups);
    LocalEdits both = then;
    apply(second, both);
    for (const std::int32_t g : groups) after.push_back(both.of(g));
    sortUnique(after);
    const LocalEdits::Surroundings now = both.around({after}), was = before.around({groups});
    return isBetter(judge(now, limits), judge(was, limits)) && hasNoMoreTwice(now.mesh, was.mesh);
}

} // namespace

std::optional<std::array<LocalEdits::Trial, 2>> findPair(const PolyMesh& mesh, std::int32_t face, const DictionaryLimits& limits, std::int32_t thinFrom,
                                                         const LocalEdits& edits) {
    const std::vector<LocalEdits::Trial> firsts = Changer(mesh, edits, limits, thinFrom).all(face);
    std::vector<std::optional<LocalEdits::Trial>> seconds(firsts.size());
    parallelFor(firsts.size(), [&](Index i) {
        if (judge(edits.around(firsts[i]), limits).faces > judge(edits.around({firsts[i].groups}), limits).faces + mostNew) return;
        LocalEdits then = edits;
        apply(firsts[i], then);
        const Changer changer(mesh, then, limits, thinFrom);
        std::vector<std::int32_t> faces{face};
        for (const std::int32_t g : firsts[i].groups) then.facesOf(then.of(g), faces);
        sortUnique(faces);
        for (const std::int32_t f : faces) {
            const std::optional<LocalEdits::Trial> second = changer.findSmall(f);
            if (!second || !areBetter(edits, then, firsts[i], *second, limits)) continue;
            seconds[i] = second;
            return;
        }
    }, 1);
    for (Index i = 0; i < firsts.size(); ++i)
        if (seconds[i]) return std::array{firsts[i], *seconds[i]};
    return {};
}

} // namespace i2b
