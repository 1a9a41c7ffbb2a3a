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

// The faces that are left, in their new order: most keep their places, since numbers keep the order of cells.
class FaceOrder {
  public:
    FaceOrder(const PolyMesh& mesh, const std::vector<std::int32_t>& groups) : mesh_(mesh), groups_(groups) {
        const Index internal = mesh.neighbour.size();
        const auto pick = [&](bool wantPlain) {
            return collect<std::uint32_t>(internal, [&](Index f, const auto& put) {
                const Sides s = sides(f);
                if (s.low != s.high && (s.low == mesh.owner[f] && s.high == mesh.neighbour[f]) == wantPlain) put(static_cast<std::uint32_t>(f));
            });
        };
        const auto before = [this](std::uint32_t a, std::uint32_t b) {
            const Sides s = sides(a), t = sides(b);
            return s.low != t.low ? s.low < t.low : s.high < t.high;
        };
        const RawVector<std::uint32_t> plain = pick(true);
        RawVector<std::uint32_t> changed = pick(false); // few
        std::stable_sort(changed.begin(), changed.end(), before);
        internal_ = plain.size() + changed.size();
        order_.resize(internal_ + Index(mesh.faces()) - internal);
        std::vector<Index> at; // of the plain ones, where those that changed go in: after those that are alike
        for (const std::uint32_t f : changed) at.push_back(static_cast<Index>(std::upper_bound(plain.begin(), plain.end(), f, before) - plain.begin()));
        for (Index k = 0; k < changed.size(); ++k) order_[at[k] + k] = changed[k];
        parallelFor(plain.size(), [&](Index i) { order_[i + Index(std::upper_bound(at.begin(), at.end(), i) - at.begin())] = plain[i]; }, 8192);
        parallelFor(order_.size() - internal_, [&](Index i) { order_[internal_ + i] = static_cast<std::uint32_t>(internal + i); }, 16384);
    }
    Index size() const { return order_.size(); }
    Index internal() const { return internal_; }
    Index face(Index i) const { return order_[i]; }
    bool isTurned(Index i) const { return i < internal_ && groups_[Index(mesh_.owner[order_[i]])] > groups_[Index(mesh_.neighbour[order_[i]])]; }

  private:
    struct Sides { std::int32_t low, high; };
    Sides sides(Index f) const {
        const std::int32_t a = groups_[Index(mesh_.owner[f])], b = groups_[Index(mesh_.neighbour[f])];
        return {std::min(a, b), std::max(a, b)};
    }

    const PolyMesh& mesh_;
    const std::vector<std::int32_t>& groups_;
    RawVector<std::uint32_t> order_;
    Index internal_ = 0;
};

// What becomes of each face.
class Divisions {
  public:
    Divisions(const PolyMesh& mesh, const MeshEdits& edits) : mesh_(mesh), divided_(edits.divided), isDivided_(Index(mesh.faces()), 0) {
        for (const auto& [face, from] : divided_) isDivided_[Index(face)] = 1;
    }
    const std::uint32_t* of(Index face) const { // null: stays whole
        if (!isDivided_[face]) return nullptr; // nearly all
        const auto at = std::lower_bound(divided_.begin(), divided_.end(), face, [](const auto& one, Index f) { return Index(one.first) < f; });
        return &at->second;
    }
    std::uint32_t pieces(Index face) const { return of(face) ? size(face) - 2 : 1; }
    std::uint32_t vertices(Index face) const { return of(face) ? 3 * (size(face) - 2) : size(face); } // of all pieces

  private:
    std::uint32_t size(Index face) const { return mesh_.faceOffsets[face + 1] - mesh_.faceOffsets[face]; }
    const PolyMesh& mesh_;
    const std::vector<std::pair<std::int32_t, std::uint32_t>>& divided_;
    std::vector<std::uint8_t> isDivided_; // per face
};

// Where what comes of each face in the new order begins; one more at the end.
RawVector<std::uint32_t> scan(const FaceOrder& order, const auto& count) {
    return sumsBefore<std::uint32_t>(order.size(), [&](Index i) { return count(order.face(i)); });
}

void rewriteVertices(PolyMesh& mesh, const FaceOrder& order, const Divisions& divisions, const RawVector<std::uint32_t>& firstPiece) {
    const RawVector<std::uint32_t> first = scan(order, [&](Index f) { return divisions.vertices(f); });
    RawVector<std::int32_t> vertices(first.back());
    RawVector<std::uint32_t> offsets(firstPiece.back() + 1);
    offsets.back() = first.back();
    parallelFor(order.size(), [&](Index i) {
        const auto v = mesh.face(static_cast<std::int32_t>(order.face(i)));
        const std::uint32_t* const division = divisions.of(order.face(i));
        std::uint32_t at = first[i];
        if (!division) {
            offsets[firstPiece[i]] = at;
            std::copy(v.begin(), v.end(), vertices.begin() + at);
            if (order.isTurned(i)) std::reverse(vertices.begin() + at + 1, vertices.begin() + static_cast<std::ptrdiff_t>(at + v.size()));
            return;
        }
        std::uint32_t piece = firstPiece[i];
        for (const FaceTriangle& triangle : trianglesOf(mesh.points, v, *division)) {
            offsets[piece++] = at;
            for (Index k = 0; k < 3; ++k) vertices[at + k] = v[triangle[k]];
            if (order.isTurned(i)) std::swap(vertices[at + 1], vertices[at + 2]);
            at += 3;
        }
    });
    mesh.faceVertices = std::move(vertices);
    mesh.faceOffsets = std::move(offsets);
}

void rewriteSides(PolyMesh& mesh, const FaceOrder& order, const std::vector<std::int32_t>& number, const RawVector<std::uint32_t>& firstPiece) {
    RawVector<std::int32_t> owner(firstPiece.back()), neighbour(firstPiece[order.internal()]);
    parallelFor(order.size(), [&](Index i) {
        const std::int32_t own = number[Index(mesh.owner[order.face(i)])];
        const std::int32_t nei = i < order.internal() ? number[Index(mesh.neighbour[order.face(i)])] : own;
        for (Index k = firstPiece[i]; k < firstPiece[i + 1]; ++k) {
            owner[k] = std::min(own, nei);
            if (i < order.internal()) neighbour[k] = std::max(own, nei);
        }
    });
    Index i = order.internal();
    for (Patch& patch : mesh.patches) {
        const Index end = i + Index(patch.count);
        patch.start = static_cast<std::int32_t>(firstPiece[i]);
        patch.count = static_cast<std::int32_t>(firstPiece[end] - firstPiece[i]);
        i = end;
    }
    mesh.owner = std::move(owner), mesh.neighbour = std::move(neighbour);
}

void rewriteFaces(PolyMesh& mesh, const MeshEdits& edits, const std::vector<std::int32_t>& number) {
    const FaceOrder order(mesh, edits.groups);
    const Divisions divisions(mesh, edits);
    const RawVector<std::uint32_t> firstPiece = scan(order, [&](Index f) { return divisions.pieces(f); });
    rewriteVertices(mesh, order, divisions, firstPiece);
    rewriteSides(mesh, order, number, firstPiece);
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
