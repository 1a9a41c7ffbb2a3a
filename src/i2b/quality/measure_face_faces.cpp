// Pairs of faces that share points: all of them (duplicates), or some that do not follow each other on both
// faces.
#include "i2b/quality/measure_steps.h"
#include <algorithm>
#include <array>

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

// From the first shared vertex of a, walk back to where the shared stretch begins, then forward along both
// faces for as many vertices as are shared: do the two keep step? The walks are checkMesh's; on faces with
// repeated vertices the first could go round forever, hence its limit.
bool sharedInStep(Face a, Face b, std::int32_t shared) {
    for (Index i = 0; i < a.size(); ++i) {
        const auto found = std::find(b.begin(), b.end(), a[i]);
        if (found == b.end()) continue;
        const auto j = static_cast<Index>(found - b.begin());
        const std::int32_t nextA = a[wrapped(i, 1, a.size())], beforeA = a[wrapped(i, -1, a.size())];
        const std::int32_t nextB = b[wrapped(j, 1, b.size())], beforeB = b[wrapped(j, -1, b.size())];
        int stepA = 1, stepB = -1;
        if (nextB == nextA)
            stepA = 1, stepB = 1;
        else if (nextB == beforeA)
            stepA = -1, stepB = 1;
        else if (beforeB == beforeA)
            stepA = -1, stepB = -1;
        Index atA = i, atB = j, steps = 0;
        do {
            atA = wrapped(atA, stepA, a.size());
            atB = wrapped(atB, stepB, b.size());
        } while (a[atA] == b[atB] && ++steps < a.size() + b.size());
        for (std::int32_t k = 0; k < shared; ++k) {
            atA = wrapped(atA, -stepA, a.size());
            atB = wrapped(atB, -stepB, b.size());
            if (a[atA] != b[atB]) return false;
        }
        return true;
    }
    return true;
}

void checkFace(const PolyMesh& mesh, const Rows& pointFaces, std::int32_t f, SharedCounts& counts,
               PairPart& part) {
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
            if (sharedInStep(face, other, shared)) return;
            outOfStep = true;
        }
        part.faces.push_back(f);
        part.faces.push_back(g);
    });
    part.duplicates += duplicate ? 1 : 0;
    part.nonConsecutive += outOfStep ? 1 : 0;
}

} // namespace

void measureFaceFaces(Measurement& m, const Rows& pointFaces) {
    PairPart total;
    orderedLoop(static_cast<Index>(m.mesh.faces()), total, [&](Index begin, Index end, PairPart& part) {
        SharedCounts counts;
        for (Index f = begin; f < end; ++f)
            checkFace(m.mesh, pointFaces, static_cast<std::int32_t>(f), counts, part);
    });
    m.report.baffleFaces = total.baffles;
    m.report.duplicateFaces = total.duplicates;
    m.report.nonConsecutiveFaces = total.nonConsecutive;
    std::sort(total.faces.begin(), total.faces.end());
    total.faces.erase(std::unique(total.faces.begin(), total.faces.end()), total.faces.end());
    for (const std::int32_t f : total.faces) m.tallies.edgeFaces.hit(f);
}

} // namespace i2b
