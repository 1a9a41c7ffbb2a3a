// Pairs of faces that share points: all of them (duplicates), or some that do not follow each other on both
// faces.
#include "i2b/core/flags.h"
#include "i2b/quality/measure_steps.h"
#include <algorithm>
#include <array>
#include <atomic>
#include <compare>

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

void checkFace(const PolyMesh& mesh, const Rows& pointFaces, std::int32_t f, SharedCounts& counts,
               PairPart& part) {
    std::vector<std::array<Index, 2>> positions;
    const Face face = mesh.face(f);
    counts.clear();
    for (const std::int32_t p : face) {
        const std::span<const std::int32_t> users = pointFaces[p];
        for (auto it = users.rbegin(); it != users.rend() && *it > f; ++it) counts.add(*it);
    }
    bool duplicate = false, outOfStep = false;
    counts.forEachShared([&](std::int32_t g, std::int32_t shared) {
        const Face other = mesh.face(g);
        const auto n = static_cast<Index>(shared);
        if (n == other.size() || n == face.size()) {
            if (other.size() == face.size())
                ++part.baffles;
            else
                duplicate = true;
        } else {
            if (shared == 2 && sharesPlainEdge(face, other)) return;
            if (sharedInStep(face, other, positions)) return;
            outOfStep = true;
        }
        part.faces.push_back(f);
        part.faces.push_back(g);
    });
    part.duplicates += duplicate ? 1 : 0;
    part.nonConsecutive += outOfStep ? 1 : 0;
}

// Filter: which faces can be of an odd pair at all? Two faces that share points oddly share some two that are
// no edge of one of the faces (a diagonal of it), or they are the same triangle, or one repeats a vertex. At
// each point the diagonals to higher points must lead to points that nothing else at this point leads to. A
// table of bits finds the exceptions, and now and then a false one.
class OddPoints {
  public:
    OddPoints(const PolyMesh& mesh, const Rows& pointFaces) : mesh_(mesh), pointFaces_(pointFaces) {}

    void mark(std::int32_t p, std::vector<std::uint8_t>& suspects) {
        if (!maybeOdd(p)) return;
        spokes_.clear();
        for (const std::int32_t f : pointFaces_[p]) addSpokes(p, f);
        std::sort(spokes_.begin(), spokes_.end());
        for (Index i = 0, j = 0; i < spokes_.size(); i = j) {
            bool odd = false;
            for (; j < spokes_.size() && spokes_[j].to == spokes_[i].to; ++j)
                odd = odd || spokes_[j].diagonal ||
                      (j > i && spokes_[j].third >= 0 && spokes_[j].third == spokes_[j - 1].third);
            if (!odd || j - i < 2) continue;
            for (Index k = i; k < j; ++k) setFlag(suspects[Index(spokes_[k].face)]);
        }
    }

  private:
    struct Spoke {                    // from p to a higher point of the same face
        std::int32_t to, third, face; // third: a triangle's last vertex, else -1
        bool diagonal;
        friend auto operator<=>(const Spoke&, const Spoke&) = default;
    };
    static constexpr std::uint32_t words = 16;
    using Bits = std::array<std::uint64_t, words>;

    static bool set(Bits& bits, std::int32_t point) { // was it set?
        const std::uint32_t hash = (static_cast<std::uint32_t>(point) * 2654435769U) >> 22;
        const std::uint64_t bit = std::uint64_t(1) << (hash % 64);
        const bool was = (bits[hash / 64] & bit) != 0;
        bits[hash / 64] |= bit;
        return was;
    }

    // The higher points that p is joined to by edges and by diagonals of its faces. Which are higher is as
    // good as random, so lists grow without a branch. false: not simple, look closely.
    bool collect(std::int32_t p) {
        const std::span<const std::int32_t> faces = pointFaces_[p];
        Index corners = 0;
        for (const std::int32_t f : faces) corners += mesh_.face(f).size();
        if (edges_.size() < corners) edges_.resize(corners), diagonals_.resize(corners);
        edgeCount_ = diagonalCount_ = 0;
        const auto add = [p](std::vector<std::int32_t>& list, Index& count, std::int32_t to) {
            list[count] = to;
            count += to > p ? 1 : 0;
        };
        for (const std::int32_t f : faces) {
            const Face v = mesh_.face(f);
            if (v.size() == 3) return false;
            if (v.size() == 4) {
                const Index at = Index(v[1] == p) + 2 * Index(v[2] == p) + 3 * Index(v[3] == p);
                add(edges_, edgeCount_, v[(at + 1) % 4]);
                add(diagonals_, diagonalCount_, v[(at + 2) % 4]);
                add(edges_, edgeCount_, v[(at + 3) % 4]);
                continue;
            }
            const auto at = static_cast<Index>(std::find(v.begin(), v.end(), p) - v.begin());
            const Index after = wrapped(at, 1, v.size()), before = wrapped(at, -1, v.size());
            for (Index i = 0; i < v.size(); ++i)
                if (i == after || i == before)
                    add(edges_, edgeCount_, v[i]);
                else
                    add(diagonals_, diagonalCount_, v[i]);
        }
        return true;
    }

    bool maybeOdd(std::int32_t p) {
        if (!collect(p)) return true;
        Bits taken{};
        for (Index i = 0; i < edgeCount_; ++i) set(taken, edges_[i]);
        bool odd = false;
        for (Index i = 0; i < diagonalCount_; ++i) odd |= set(taken, diagonals_[i]);
        return odd;
    }

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
    std::vector<std::int32_t> edges_, diagonals_;
    Index edgeCount_ = 0, diagonalCount_ = 0;
};

std::vector<std::uint8_t> suspectFaces(const Measurement& m, const Rows& pointFaces) {
    std::vector<std::uint8_t> suspects(static_cast<Index>(m.mesh.faces()), 0);
    std::atomic<bool> isAnyRepeated = false;
    parallelChunks(m.mesh.points.size(), 2048, [&](Index begin, Index end, Index) {
        OddPoints odd(m.mesh, pointFaces);
        for (Index p = begin; p < end; ++p) {
            odd.mark(static_cast<std::int32_t>(p), suspects);
            const auto faces = pointFaces[static_cast<std::int32_t>(p)];
            if (std::ranges::adjacent_find(faces) != faces.end()) isAnyRepeated.store(true, std::memory_order_relaxed);
        }
    });
    // A repeated vertex counts twice with every face that has it.
    if (isAnyRepeated) std::fill(suspects.begin(), suspects.end(), std::uint8_t(1));
    return suspects;
}

} // namespace

void measureFaceFaces(Measurement& m, const Rows& pointFaces) {
    const std::vector<std::uint8_t> suspects = suspectFaces(m, pointFaces);
    PairPart total;
    orderedLoop(suspects.size(), total, [&](Index begin, Index end, PairPart& part) {
        SharedCounts counts;
        for (Index f = begin; f < end; ++f)
            if (suspects[f] != 0) checkFace(m.mesh, pointFaces, static_cast<std::int32_t>(f), counts, part);
    });
    m.report.baffleFaces = total.baffles;
    m.report.duplicateFaces = total.duplicates;
    m.report.nonConsecutiveFaces = total.nonConsecutive;
    std::sort(total.faces.begin(), total.faces.end());
    total.faces.erase(std::unique(total.faces.begin(), total.faces.end()), total.faces.end());
    for (const std::int32_t f : total.faces) m.tallies.edgeFaces.hit(f);
}

} // namespace i2b
