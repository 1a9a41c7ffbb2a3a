#include "i2b/fit/bends.h"
#include "i2b/core/parallel.h"
#include "i2b/fit/lie.h"
#include "i2b/front/replace_faces.h"
#include <algorithm>
#include <array>
#include <cmath>

namespace i2b {
namespace {

// What a cut must bring. off: of h, the quad's middle at least; gain: share of that, at most, that the pieces may be off on
// average. On a sphere it is about 0.9.
struct Want { double off, gain; };
constexpr Want want{0.005, 0.95};
// Where it may make the cell behind the front concave: of quads that lie along the geometry, and of others. Smooth walls stay
// quads.
constexpr Want concaveWant{0.03, 0.5}, leantConcaveWant{0.01, 0.75};
constexpr double leastBulge = 0.06;  // of h: of the front's quad at the cut, for the cell behind to stay convex as nodes go on moving
constexpr double leastCorner = 0.1;  // scaled Jacobian that the prisms of the pieces must have
const double leant = std::cos(6 * 3.14159265358979323846 / 180);

bool brings(const Want& wanted, double before, double after, double h) { return before > wanted.off * h && after < wanted.gain * before; }

using Quad = std::array<std::size_t, 4>; // vertices

class BendCutter {
  public:
    BendCutter(const Front& front, const SurfaceIndex& index) : front_(front), index_(index) {}
    // The vertex that the better cut starts from, 0 or 1; -1: none.
    int cutOf(const Quad& q) const;

  private:
    Lie lieOf(std::span<const Vec3> x, double h) const { return i2b::lieOf(index_, x, h); }
    bool isSound(std::size_t a, std::size_t b, std::size_t c) const; // in the sense of the face
    bool mayMakeConcave(const Quad& q, int cut) const;

    const Front& front_;
    const SurfaceIndex& index_;
};

// The prism on a triangle.
bool BendCutter::isSound(std::size_t a, std::size_t b, std::size_t c) const {
    // Over a divided edge and the vertex in it a piece would have a face on some of the points of the next one.
    const std::array vertices{static_cast<std::int32_t>(a), static_cast<std::int32_t>(b), static_cast<std::int32_t>(c)};
    if (front_.areOnOneEdge(vertices)) return false;
    return std::min({front_.cornerAt(a, c, b), front_.cornerAt(b, a, c), front_.cornerAt(c, b, a)}) >= leastCorner;
}

// Does the edge between the front's pieces stick into the cell behind it?
bool BendCutter::mayMakeConcave(const Quad& q, int cut) const {
    Vec3 bulge, toWall;
    for (std::size_t i = 0; i < 4; ++i) {
        const Vec3& f = front_.front[q[i]];
        bulge += static_cast<int>(i % 2) == cut ? f : -f;
        toWall += front_.wall(q[i]) - f;
    }
    return !(dot(bulge, normalized(toWall)) > leastBulge * front_.h[q[0]]);
}

int BendCutter::cutOf(const Quad& q) const {
    const double h = front_.h[q[0]];
    const std::array<Vec3, 4> x{front_.wall(q[0]), front_.wall(q[1]), front_.wall(q[2]), front_.wall(q[3])};
    const Lie whole = lieOf(x, h);
    if (whole.off <= want.off * h) return -1;
    int best = -1;
    double least = want.gain * whole.off;
    for (const int d : {0, 1}) {
        const auto i = static_cast<std::size_t>(d), j = i + 1, k = i + 2, l = (i + 3) % 4;
        const Lie one = lieOf(std::array{x[i], x[j], x[k]}, h), other = lieOf(std::array{x[i], x[k], x[l]}, h);
        const double off = 0.5 * (one.off + other.off);
        if (!(off < least) || std::min(one.cosine, other.cosine) < std::min(tilted, whole.cosine)) continue;
        if (!brings(whole.cosine < leant ? leantConcaveWant : concaveWant, whole.off, off, h) && mayMakeConcave(q, d)) continue;
        if (!isSound(q[i], q[j], q[k]) || !isSound(q[i], q[k], q[l])) continue;
        least = off, best = d;
    }
    return best;
}

} // namespace

std::size_t cutAcrossBends(Front& front, const SurfaceIndex& index) {
    const BendCutter cutter(front, index);
    const std::size_t faces = front.ownerCell.size();
    const auto quadOf = [&](std::size_t f, Quad& q) {
        std::size_t n = 0;
        for (auto v : front.mesh.fv_range(FrontMesh::FaceHandle(static_cast<int>(f)))) {
            if (n < 4) q[n] = static_cast<std::size_t>(v.idx());
            ++n;
        }
        return n == 4 && !front.staysWhole(f);
    };
    std::vector<std::int8_t> cut(faces, -1);
    parallelFor(faces, [&](std::size_t f) {
        Quad q{};
        if (quadOf(f, q)) cut[f] = static_cast<std::int8_t>(cutter.cutOf(q));
    }, 256);
    std::vector<FaceCut> cuts;
    for (std::size_t f = 0; f < faces; ++f) {
        if (cut[f] < 0) continue;
        Quad q{};
        quadOf(f, q);
        const auto v = [&](int i) { return static_cast<std::int32_t>(q[static_cast<std::size_t>((cut[f] + i) % 4)]); };
        cuts.push_back({static_cast<std::int32_t>(f), {{v(0), v(1), v(2)}, {v(0), v(2), v(3)}}});
    }
    replaceFaces(front, cuts);
    return cuts.size();
}

} // namespace i2b
