#include "i2b/quality/odd_points.h"
#include "i2b/core/flags.h"
#include "i2b/core/parallel.h"
#include "i2b/core/raw_fill.h"
#include "i2b/quality/face_measure.h"
#include <algorithm>
#include <array>
#include <atomic>
#include <span>

namespace i2b {
namespace {

using Index = std::size_t;
using Face = std::span<const std::int32_t>;
constexpr Index grain = 4096;

// The other ends of diagonals at a point, and a number below -1 for each triangle whose lowest point it is. Of a mesh of hexahedra there are
// six diagonals a point.
struct alignas(32) Ends {
    static constexpr std::int32_t room = 7, nothing = -1;
    std::int32_t count = 0; // that there would be, were there room
    std::array<std::int32_t, room> point{nothing, nothing, nothing, nothing, nothing, nothing, nothing};

    bool put(std::int32_t end) {
        const std::int32_t place = std::atomic_ref(count).fetch_add(1, std::memory_order_relaxed);
        if (place < room) point[Index(place)] = end;
        return place < room;
    }
    bool has(std::int32_t p) const {
        bool found = false;
        for (const std::int32_t q : point) found |= q == p;
        return found;
    }
    bool hasTwice() const {
        bool found = false;
        for (Index i = 1; i < Index(room); ++i)
            for (Index k = 0; k < i; ++k) found |= point[i] == point[k] && point[i] != nothing;
        return found;
    }
};

class Finder {
  public:
    explicit Finder(const PolyMesh& mesh) : mesh_(mesh), odd_(mesh.points.size(), 0), ends_(filled(mesh.points.size(), Ends{})) {}

    OddPoints find() {
        forFaces([&](Face v) { addDiagonals(v); });
        if (anyTwice_.load()) {
            std::fill(odd_.begin(), odd_.end(), std::uint8_t(1));
            return {std::move(odd_), true};
        }
        parallelFor(ends_.size(), [&](Index p) { compareDiagonals(static_cast<std::int32_t>(p)); }, grain);
        forFaces([&](Face v) { compareEdges(v); });
        return {std::move(odd_), false};
    }

  private:
    template <class Body>
    void forFaces(const Body& body) {
        parallelFor(Index(mesh_.faces()), [&](Index f) { body(mesh_.face(static_cast<std::int32_t>(f))); }, grain);
    }
    // At its lower end, else at the other one, where there is room.
    void addDiagonal(std::int32_t a, std::int32_t b) {
        const std::int32_t low = std::min(a, b), high = std::max(a, b);
        if (!ends_[Index(low)].put(high) && !ends_[Index(high)].put(low)) setFlag(odd_[Index(low)]);
    }
    void addTriangle(Face v) {
        const auto [low, high] = std::ranges::minmax(v);
        const std::uint32_t hash = static_cast<std::uint32_t>(v[0] ^ v[1] ^ v[2] ^ low ^ high) * 2654435769U ^ static_cast<std::uint32_t>(high) * 2246822519U;
        if (!ends_[Index(low)].put(-2 - static_cast<std::int32_t>(hash >> 2))) setFlag(odd_[Index(low)]);
    }
    void addDiagonals(Face v) {
        if (repeatedVertices(v, v.size()) > 0) anyTwice_.store(true, std::memory_order_relaxed);
        else if (v.size() == 4) addDiagonal(v[0], v[2]), addDiagonal(v[1], v[3]);
        else if (v.size() == 3) addTriangle(v);
        else
            for (Index i = 0; i + 2 < v.size(); ++i)
                for (Index k = i + 2; k < v.size(); ++k)
                    if (i > 0 || k + 1 < v.size()) addDiagonal(v[i], v[k]);
    }
    void compareDiagonals(std::int32_t p) {
        const Ends& ends = ends_[Index(p)];
        if (ends.hasTwice()) // at which end, they do not say
            for (const std::int32_t q : ends.point) setFlag(odd_[Index(q >= 0 && q < p ? q : p)]);
        for (const std::int32_t q : ends.point) // of those that had no room at their lower end
            if (q >= 0 && q < p && ends_[Index(q)].has(p)) setFlag(odd_[Index(q)]);
    }
    void compareEdges(Face v) {
        for (Index i = 0; i < v.size(); ++i) {
            const std::int32_t a = v[i], b = v[i + 1 == v.size() ? 0 : i + 1], low = std::min(a, b), high = std::max(a, b);
            const Ends& ends = ends_[Index(low)];
            if (ends.has(high) || (ends.count > Ends::room && ends_[Index(high)].has(low))) setFlag(odd_[Index(low)]);
        }
    }

    const PolyMesh& mesh_;
    std::vector<std::uint8_t> odd_;
    RawVector<Ends> ends_;
    std::atomic<bool> anyTwice_ = false;
};

} // namespace

OddPoints oddPoints(const PolyMesh& mesh) { return Finder(mesh).find(); }

} // namespace i2b
