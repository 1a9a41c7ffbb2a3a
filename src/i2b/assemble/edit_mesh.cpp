#include "i2b/assemble/edit_mesh.h"
#include "i2b/core/collect.h"
#include "i2b/core/sums.h"
#include <algorithm>

namespace i2b {
namespace {

using Index = std::size_t;

// Numbers of the cells that are left.
std::vector<std::int32_t> numberCells(const std::vector<std::int32_t>& groups, std::int32_t& count) {
    const RawVector<std::uint32_t> before = sumsBefore<std::uint32_t>(groups.size(), [&](Index c) { return Index(groups[c]) == c; });
    std::vector<std::int32_t> number(groups.size());
    parallelFor(groups.size(), [&](Index c) { number[c] = static_cast<std::int32_t>(before[Index(groups[c])]); }, 8192);
    count = static_cast<std::int32_t>(before[groups.size()]);
    return number;
}

// Faces that follow each other before and after, with the cells at their sides as they were but for their numbers; or a single one.
struct Run {
    Index face = 0, count = 0;               // of before
    Index piece = 0, vertex = 0;             // where what becomes of them begins
    const std::uint32_t* division = nullptr; // of a single face: how it is divided
    bool isTurned = false;
};

// All faces that are left, in their new order. Few change: the others stay where they are between these, since numbers keep the order
// of cells.
class Runs {
  public:
    Runs(const PolyMesh& mesh, const MeshEdits& edits);
    std::span<const Run> all() const { return {runs_.data(), runs_.size() - 1}; }
    Index pieces() const { return runs_.back().piece; }
    Index internalPieces() const { return runs_[firstBoundary_].piece; }
    Index vertices() const { return runs_.back().vertex; }
    Index piecesOf(const Run& run) const { return (&run + 1)->piece - run.piece; } // there is always one more
    Index placeOf(Index boundaryFace) const; // its first piece; of the mesh's last face and one more: the end

  private:
    static constexpr Index most = 16384; // faces in a run, so that threads share them

    struct Sides { std::int32_t low, high; };
    Sides sides(Index f) const {
        const std::int32_t a = groups_[Index(mesh_.owner[f])], b = groups_[Index(mesh_.neighbour[f])];
        return {std::min(a, b), std::max(a, b)};
    }
    Index firstAfter(const Sides& s) const;
    auto firstDivided(Index face) const { // from this one on
        return std::lower_bound(divided_.begin(), divided_.end(), face, [](const auto& one, Index f) { return Index(one.first) < f; });
    }
    void addWhole(Index begin, Index end);
    void addAlone(Index face);
    void addUpTo(Index end); // of those that stay where they are
    void place();

    const PolyMesh& mesh_;
    const std::vector<std::int32_t>& groups_;
    const std::vector<std::pair<std::int32_t, std::uint32_t>>& divided_;
    std::vector<Run> runs_; // and one without faces at the end
    Index firstBoundary_ = 0, next_ = 0;
};

Runs::Runs(const PolyMesh& mesh, const MeshEdits& edits) : mesh_(mesh), groups_(edits.groups), divided_(edits.divided) {
    const Index internal = mesh.neighbour.size();
    const RawVector<std::uint32_t> leaving = collect<std::uint32_t>(internal, [&](Index f, const auto& put) {
        const Sides s = sides(f);
        if (s.low == s.high || s.low != mesh.owner[f] || s.high != mesh.neighbour[f]) put(static_cast<std::uint32_t>(f));
    });
    struct Moved { Index before, face; Sides sides; };
    std::vector<Moved> moved; // goes before that face; of the same place in the order of its new sides
    for (const std::uint32_t f : leaving) {
        if (const Sides s = sides(f); s.low != s.high) moved.push_back({firstAfter(s), f, s});
    }
    std::ranges::stable_sort(moved, [](const Moved& a, const Moved& b) { return a.sides.low != b.sides.low ? a.sides.low < b.sides.low : a.sides.high < b.sides.high; });
    auto in = moved.begin();
    const auto addMovedBefore = [&](Index face) {
        for (; in != moved.end() && in->before <= face; ++in) addUpTo(in->before), addAlone(in->face);
    };
    for (const std::uint32_t f : leaving) {
        addMovedBefore(f);
        addUpTo(f);
        next_ = Index(f) + 1;
    }
    addMovedBefore(internal);
    addUpTo(internal);
    firstBoundary_ = runs_.size();
    addUpTo(mesh.owner.size());
    place();
}

// The first internal face whose sides, as they were, come after these.
Index Runs::firstAfter(const Sides& s) const {
    Index begin = 0, end = mesh_.neighbour.size();
    while (begin < end) {
        const Index middle = begin + (end - begin) / 2;
        const bool isAfter = mesh_.owner[middle] != s.low ? mesh_.owner[middle] > s.low : mesh_.neighbour[middle] > s.high;
        if (isAfter) end = middle;
        else begin = middle + 1;
    }
    return begin;
}

void Runs::addWhole(Index begin, Index end) {
    for (; begin < end; begin += most) runs_.push_back({begin, std::min(most, end - begin)});
}

void Runs::addAlone(Index face) {
    const auto at = firstDivided(face);
    const bool isDivided = at != divided_.end() && Index(at->first) == face;
    const bool isTurned = face < mesh_.neighbour.size() && groups_[Index(mesh_.owner[face])] > groups_[Index(mesh_.neighbour[face])];
    runs_.push_back({face, 1, 0, 0, isDivided ? &at->second : nullptr, isTurned});
}

void Runs::addUpTo(Index end) {
    for (auto at = firstDivided(next_); at != divided_.end() && Index(at->first) < end; ++at) {
        addWhole(next_, Index(at->first));
        addAlone(Index(at->first));
        next_ = Index(at->first) + 1;
    }
    addWhole(next_, end);
    next_ = std::max(next_, end);
}

void Runs::place() {
    runs_.push_back({});
    Index piece = 0, vertex = 0;
    for (Run& run : runs_) {
        run.piece = piece, run.vertex = vertex;
        const Index vertices = mesh_.faceOffsets[run.face + run.count] - mesh_.faceOffsets[run.face];
        piece += run.division ? vertices - 2 : run.count;
        vertex += run.division ? 3 * (vertices - 2) : vertices;
    }
}

Index Runs::placeOf(Index boundaryFace) const {
    const auto first = runs_.begin() + std::ptrdiff_t(firstBoundary_), last = runs_.end() - 1;
    const auto at = std::partition_point(first, last, [&](const Run& run) { return run.face + run.count <= boundaryFace; });
    return at == last ? pieces() : at->piece + (boundaryFace - at->face);
}

void rewriteVertices(PolyMesh& mesh, const Runs& runs) {
    RawVector<std::int32_t> vertices(runs.vertices());
    parallelFor(runs.all().size(), [&](Index i) {
        const Run& run = runs.all()[i];
        std::int32_t* to = vertices.data() + run.vertex;
        if (run.division) {
            const auto v = mesh.face(static_cast<std::int32_t>(run.face));
            for (FaceTriangle triangle : trianglesOf(mesh.points, v, *run.division)) {
                if (run.isTurned) std::swap(triangle[1], triangle[2]);
                for (const std::uint32_t k : triangle) *to++ = v[k];
            }
            return;
        }
        const std::int32_t* const from = mesh.faceVertices.data();
        std::int32_t* const end = std::copy(from + mesh.faceOffsets[run.face], from + mesh.faceOffsets[run.face + run.count], to);
        if (run.isTurned) std::reverse(to + 1, end);
    }, 1);
    mesh.faceVertices = std::move(vertices);
}

void rewriteOffsets(PolyMesh& mesh, const Runs& runs) {
    RawVector<std::uint32_t> offsets(runs.pieces() + 1);
    offsets.back() = static_cast<std::uint32_t>(runs.vertices());
    parallelFor(runs.all().size(), [&](Index i) {
        const Run& run = runs.all()[i];
        for (Index k = 0, n = runs.piecesOf(run); k < n; ++k)
            offsets[run.piece + k] = static_cast<std::uint32_t>(run.vertex + (run.division ? 3 * k : mesh.faceOffsets[run.face + k] - mesh.faceOffsets[run.face]));
    }, 1);
    mesh.faceOffsets = std::move(offsets);
}

void rewriteSides(PolyMesh& mesh, const Runs& runs, const std::vector<std::int32_t>& number) {
    const Index internal = runs.internalPieces();
    RawVector<std::int32_t> owner(runs.pieces()), neighbour(internal);
    parallelFor(runs.all().size(), [&](Index i) {
        const Run& run = runs.all()[i];
        for (Index k = 0, n = runs.piecesOf(run); k < n; ++k) {
            const Index face = run.face + (run.division ? 0 : k), piece = run.piece + k;
            const std::int32_t own = number[Index(mesh.owner[face])];
            const std::int32_t nei = piece < internal ? number[Index(mesh.neighbour[face])] : own;
            owner[piece] = std::min(own, nei);
            if (piece < internal) neighbour[piece] = std::max(own, nei);
        }
    }, 1);
    mesh.owner = std::move(owner), mesh.neighbour = std::move(neighbour);
}

// One array after the other, so that only one is there twice at a time.
void rewriteFaces(PolyMesh& mesh, const MeshEdits& edits, const std::vector<std::int32_t>& number) {
    const Runs runs(mesh, edits);
    for (Patch& patch : mesh.patches) {
        const Index start = runs.placeOf(Index(patch.start)), end = runs.placeOf(Index(patch.start) + Index(patch.count));
        patch.start = static_cast<std::int32_t>(start), patch.count = static_cast<std::int32_t>(end - start);
    }
    rewriteVertices(mesh, runs);
    rewriteOffsets(mesh, runs);
    rewriteSides(mesh, runs, number);
}

template <class T, class Join>
void uniteValues(std::vector<T>& values, const std::vector<std::int32_t>& groups, const std::vector<std::int32_t>& number, std::int32_t count,
                 const Join& join) {
    if (values.empty()) return;
    for (Index c = 0; c < groups.size(); ++c) { // numbers do not grow: in place
        T& to = values[Index(number[c])];
        to = Index(groups[c]) == c ? values[c] : join(to, values[c]);
    }
    values.resize(Index(count));
}

} // namespace

std::vector<std::int32_t> editMesh(PolyMesh& mesh, const MeshEdits& edits) {
    const std::vector<std::int32_t>& groups = edits.groups;
    std::int32_t count = 0;
    std::vector<std::int32_t> number = numberCells(groups, count);
    rewriteFaces(mesh, edits, number);
    const auto first = [](auto a, auto) { return a; };
    uniteValues(mesh.cellLevel, groups, number, count, first);
    uniteValues(mesh.cellRegion, groups, number, count, first);
    uniteValues(mesh.cellLayer, groups, number, count, [](std::uint8_t a, std::uint8_t b) { return a == 0 || b == 0 ? std::max(a, b) : std::min(a, b); });
    for (CellZone& zone : mesh.zones) {
        for (std::int32_t& c : zone.cells) c = number[Index(c)];
        std::sort(zone.cells.begin(), zone.cells.end());
        zone.cells.erase(std::unique(zone.cells.begin(), zone.cells.end()), zone.cells.end());
    }
    mesh.cells = count;
    return number;
}

} // namespace i2b
