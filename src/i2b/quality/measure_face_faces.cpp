// Pairs of faces that share points: all of them (duplicates), or some that do not follow each other on both
// faces.
#include "i2b/core/collect.h"
#include "i2b/core/rows.h"
#include "i2b/quality/measure_steps.h"
#include "i2b/quality/odd_points.h"
#include <algorithm>
#include <array>
#include <compare>
#include <tbb/parallel_sort.h>

namespace i2b {
namespace {

using Index = std::size_t;
using Face = std::span<const std::int32_t>;

struct PairPart {
    std::int64_t baffles = 0, duplicates = 0, nonConsecutive = 0;
    std::vector<std::int32_t> faces; // of both sides, in no order, with repetitions
    void join(const PairPart& o) {
        baffles += o.baffles, duplicates += o.duplicates, nonConsecutive += o.nonConsecutive;
        faces.insert(faces.end(), o.faces.begin(), o.faces.end());
    }
};

// How often each later face shares a point with the face at hand: a hash table that empties itself.
class SharedCounts {
  public:
    void clear() {
        for (const std::uint32_t slot : used_) faces_[slot] = -1;
        used_.clear();
    }
    void add(std::int32_t face) {
        if (used_.size() * 2 >= faces_.size()) grow();
        const std::uint32_t slot = find(face);
        if (faces_[slot] == face) {
            ++counts_[slot];
            return;
        }
        faces_[slot] = face;
        counts_[slot] = 1;
        used_.push_back(slot);
    }
    template <class Body>
    void forEachShared(const Body& body) const {
        for (const std::uint32_t slot : used_)
            if (counts_[slot] >= 2) body(faces_[slot], counts_[slot]);
    }

  private:
    std::uint32_t find(std::int32_t face) const {
        const auto mask = static_cast<std::uint32_t>(faces_.size() - 1);
        std::uint32_t slot = (static_cast<std::uint32_t>(face) * 2654435769U >> 16) & mask;
        while (faces_[slot] != -1 && faces_[slot] != face) slot = (slot + 1) & mask;
        return slot;
    }
    void grow() {
        std::vector<std::pair<std::int32_t, std::int32_t>> old;
        for (const std::uint32_t slot : used_) old.emplace_back(faces_[slot], counts_[slot]);
        faces_.assign(faces_.size() * 2, -1);
        counts_.assign(faces_.size(), 0);
        used_.clear();
        for (const auto& [face, count] : old) {
            const std::uint32_t slot = find(face);
            faces_[slot] = face;
            counts_[slot] = count;
            used_.push_back(slot);
        }
    }
    std::vector<std::int32_t> faces_ = std::vector<std::int32_t>(256, -1);
    std::vector<std::int32_t> counts_ = std::vector<std::int32_t>(256, 0);
    std::vector<std::uint32_t> used_;
};

Index wrapped(Index i, int step, Index n) {
    return step > 0 ? (i + 1 == n ? 0 : i + 1) : (i == 0 ? n - 1 : i - 1);
}

// Two shared points that are neighbours on both faces: one shared edge, by far the commonest case.
bool sharesPlainEdge(Face a, Face b) {
    Index first = a.size(), count = 0, last = 0;
    for (Index i = 0; i < a.size(); ++i)
        if (std::find(b.begin(), b.end(), a[i]) != b.end()) {
            if (count++ == 0) first = i;
            last = i;
        }
    if (count != 2 || !(last == first + 1 || (first == 0 && last == a.size() - 1))) return false;
    const auto at = static_cast<Index>(std::find(b.begin(), b.end(), a[first]) - b.begin());
    return b[wrapped(at, 1, b.size())] == a[last] || b[wrapped(at, -1, b.size())] == a[last];
}

// Do the vertices that a and b share, two or more but not all, make one unbroken stretch of both outlines, in
// the same or in opposite order? Listed by their position on a, the stretch begins after the only gap there;
// from then on the position on b must always go one up or always one down. Repeated vertices, which fail a
// check of their own, count where they come first.
bool sharedInStep(Face a, Face b, std::vector<std::array<Index, 2>>& shared) {
    shared.clear();
    for (Index i = 0; i < a.size(); ++i) {
        if (std::find(a.begin(), a.begin() + std::ptrdiff_t(i), a[i]) != a.begin() + std::ptrdiff_t(i))
            continue;
        const auto found = std::find(b.begin(), b.end(), a[i]);
        if (found != b.end()) shared.push_back({i, static_cast<Index>(found - b.begin())});
    }
    const Index n = shared.size();
    Index begin = 0, gaps = 0;
    for (Index i = 0; i < n; ++i)
        if (wrapped(shared[i][0], 1, a.size()) != shared[(i + 1) % n][0]) begin = (i + 1) % n, ++gaps;
    if (gaps > 1) return false;
    bool up = true, down = true;
    for (Index i = 0; i + 1 < n; ++i) {
        const Index here = shared[(begin + i) % n][1], next = shared[(begin + i + 1) % n][1];
        up = up && next == wrapped(here, 1, b.size());
        down = down && next == wrapped(here, -1, b.size());
    }
    return up || down;
}

// What a face has with others, told once for each.
class FacePairs {
  public:
    FacePairs(const PolyMesh& mesh, PairPart& part) : mesh_(mesh), part_(part) {}

    void begin() { duplicate_ = outOfStep_ = false; }
    // shared: how many points the faces share, two or more
    void add(std::int32_t f, std::int32_t g, Index shared) {
        const Face face = mesh_.face(f), other = mesh_.face(g);
        if (shared == other.size() || shared == face.size()) {
            if (other.size() == face.size())
                ++part_.baffles;
            else
                duplicate_ = true;
        } else {
            if (shared == 2 && sharesPlainEdge(face, other)) return;
            if (sharedInStep(face, other, positions_)) return;
            outOfStep_ = true;
        }
        part_.faces.push_back(f);
        part_.faces.push_back(g);
    }
    void end() {
        part_.duplicates += duplicate_ ? 1 : 0;
        part_.nonConsecutive += outOfStep_ ? 1 : 0;
    }

  private:
    const PolyMesh& mesh_;
    PairPart& part_;
    std::vector<std::array<Index, 2>> positions_;
    bool duplicate_ = false, outOfStep_ = false;
};

// The faces at the points that are marked, ascending; those of others are not listed.
Rows facesAt(const PolyMesh& mesh, const std::vector<std::uint8_t>& points) {
    const RawVector<std::int32_t> faces = collect<std::int32_t>(Index(mesh.faces()), [&](Index f, const auto& put) {
        const auto id = static_cast<std::int32_t>(f);
        if (std::ranges::any_of(mesh.face(id), [&](std::int32_t p) { return points[Index(p)] != 0; })) put(id);
    });
    Rows rows;
    const auto pointsOf = [&](Index i, const auto& put) {
        for (const std::int32_t p : mesh.face(faces[i]))
            if (points[Index(p)] != 0) put(Index(p));
    };
    turnIntoRows(mesh.points.size(), 0, faces.size(), pointsOf, rows.offsets, rows.items);
    parallelFor(rows.items.size(), [&](Index i) { rows.items[i] = faces[Index(rows.items[i])]; }, 8192);
    return rows;
}

struct Pair {
    std::int32_t face, other; // the lower one first
    friend auto operator<=>(const Pair&, const Pair&) = default;
};

// At a point the diagonals to higher points must lead to points that nothing else at this point leads to, and triangles to other pairs of
// points: else the faces are a pair that may be odd.
class PairsAtPoint {
  public:
    PairsAtPoint(const PolyMesh& mesh, const Rows& pointFaces) : mesh_(mesh), pointFaces_(pointFaces) {}

    template <class Put>
    void find(std::int32_t p, const Put& put) {
        spokes_.clear();
        for (const std::int32_t f : pointFaces_[p]) addSpokes(p, f);
        std::sort(spokes_.begin(), spokes_.end());
        for (Index i = 0, j = 0; i < spokes_.size(); i = j) {
            bool odd = false;
            for (; j < spokes_.size() && spokes_[j].to == spokes_[i].to; ++j)
                odd = odd || spokes_[j].diagonal ||
                      (j > i && spokes_[j].third >= 0 && spokes_[j].third == spokes_[j - 1].third);
            for (Index k = i; odd && k < j; ++k)
                for (Index l = i; l < k; ++l) put(Pair{std::min(spokes_[k].face, spokes_[l].face), std::max(spokes_[k].face, spokes_[l].face)});
        }
    }

  private:
    struct Spoke {                    // from p to a higher point of the same face
        std::int32_t to, third, face; // third: a triangle's last vertex, else -1
        bool diagonal;
        friend auto operator<=>(const Spoke&, const Spoke&) = default;
    };

    void addSpokes(std::int32_t p, std::int32_t f) {
        const Face v = mesh_.face(f);
        const auto at = static_cast<Index>(std::find(v.begin(), v.end(), p) - v.begin());
        for (Index i = 0; i < v.size(); ++i) {
            if (v[i] <= p) continue;
            const bool edge = i == wrapped(at, 1, v.size()) || i == wrapped(at, -1, v.size());
            spokes_.push_back({v[i], v.size() == 3 ? v[0] ^ v[1] ^ v[2] ^ p ^ v[i] : -1, f, !edge});
        }
    }

    const PolyMesh& mesh_;
    const Rows& pointFaces_;
    std::vector<Spoke> spokes_;
};

// Where no face has a point twice: ascending, each once.
RawVector<Pair> pairsToCheck(const PolyMesh& mesh, const std::vector<std::uint8_t>& odd) {
    const Rows pointFaces = facesAt(mesh, odd);
    RawVector<Pair> pairs = collect<Pair>(odd.size(), [&](Index p, const auto& put) {
        if (odd[p] != 0) PairsAtPoint(mesh, pointFaces).find(static_cast<std::int32_t>(p), put);
    });
    tbb::parallel_sort(pairs);
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    return pairs;
}

void checkPairs(const PolyMesh& mesh, const RawVector<Pair>& pairs, PairPart& total) {
    orderedLoop(pairs.size(), total, [&](Index begin, Index end, PairPart& part) {
        FacePairs found(mesh, part);
        for (Index i = begin; i < end; ++i) {
            if (i > 0 && pairs[i - 1].face == pairs[i].face) continue;
            found.begin();
            for (Index k = i; k < pairs.size() && pairs[k].face == pairs[i].face; ++k) {
                const Face other = mesh.face(pairs[k].other);
                const auto shared = std::ranges::count_if(mesh.face(pairs[k].face), [&](std::int32_t p) { return std::ranges::find(other, p) != other.end(); });
                found.add(pairs[k].face, pairs[k].other, static_cast<Index>(shared));
            }
            found.end();
        }
    });
}

// A point that a face has twice counts twice with every face that has it: all faces are compared with all that share points with them.
void checkAll(const PolyMesh& mesh, PairPart& total) {
    const Rows pointFaces = buildPointFaces(mesh);
    orderedLoop(static_cast<Index>(mesh.faces()), total, [&](Index begin, Index end, PairPart& part) {
        SharedCounts counts;
        FacePairs found(mesh, part);
        for (Index i = begin; i < end; ++i) {
            const auto f = static_cast<std::int32_t>(i);
            counts.clear();
            for (const std::int32_t p : mesh.face(f)) {
                const std::span<const std::int32_t> users = pointFaces[p];
                for (auto it = users.rbegin(); it != users.rend() && *it > f; ++it) counts.add(*it);
            }
            found.begin();
            counts.forEachShared([&](std::int32_t g, std::int32_t shared) { found.add(f, g, static_cast<Index>(shared)); });
            found.end();
        }
    });
}

} // namespace

void measureFaceFaces(Measurement& m) {
    PairPart total;
    const OddPoints odd = oddPoints(m.mesh);
    if (odd.isAnyTwice) checkAll(m.mesh, total);
    else checkPairs(m.mesh, pairsToCheck(m.mesh, odd.marks), total);
    m.report.baffleFaces = total.baffles;
    m.report.duplicateFaces = total.duplicates;
    m.report.nonConsecutiveFaces = total.nonConsecutive;
    std::sort(total.faces.begin(), total.faces.end());
    total.faces.erase(std::unique(total.faces.begin(), total.faces.end()), total.faces.end());
    for (const std::int32_t f : total.faces) m.tallies.edgeFaces.hit(f);
}

} // namespace i2b
