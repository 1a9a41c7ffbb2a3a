#include "i2b/quality/face_tets.h"
#include "i2b/core/four.h"
#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace i2b {
namespace {

using Index = std::size_t;
constexpr double least = -2;
constexpr double flat2 = 1e-20; // of the squared size of a face: a warp that no cell centre sees
constexpr double leastWidth = 1.5e-3; // area over the square of the reach from the centre: thinner faces have tetrahedra of no quality
constexpr double widthScale = 40;    // so that three times that is well
constexpr double mostReflex = 0.983; // sine of the turn at a reflex corner: a little inside maxConcave, 80 degrees

// value / sqrt(size2), where that is less than enough; else enough. Most faces are far from any limit and need no root.
double shareBelow(double enough, double value, double size2) {
    if (value > 0 && value * value >= enough * enough * size2) return enough;
    return size2 > 0 ? value / std::sqrt(size2) : least;
}

// What thinness leaves of an area, of a face's or one of its triangles.
double widthOf(const Vec3& area, double reach2, double enough) { return std::min(enough, widthScale * (norm(area) / reach2 - leastWidth)); }
// Squared area from which that is enough.
double widestSquared(double reach2, double enough) {
    const double widest = (enough / widthScale + leastWidth) * reach2;
    return widest * widest;
}

// One cell's centre, as seen from the centre of a face.
struct Apex {
    Vec3 place;        // m
    double height = 0; // m, over the face's plane, on the cell's own side

    // twice: of a triangle through p, its area vector out of the owner, m^2.
    double share(const Vec3& p, const Vec3& twice, double sign, double enough) const {
        if (!(height > 0)) return least;
        return shareBelow(enough, sign * dot(twice, p - place), norm2(twice) * height * height);
    }
};

// A glance at a quadrangle: are all its shares clearly enough? Works with squares, so that no root is taken.
class QuadLook {
  public:
    QuadLook(const Vec3& centre, const Vec3& area, const Vec3& owner, const Vec3* neighbour, double enough)
        : area_(area), enough_(enough), toOwner_(owner - centre), toNeighbour_(neighbour ? *neighbour - centre : centre - owner) {}

    bool isClear(const std::array<Vec3, 4>& p) const { // from the centre
        const double reach2 = std::max(std::max(norm2(p[0]), norm2(p[1])), std::max(norm2(p[2]), norm2(p[3])));
        const double down = -dot(area_, toOwner_), up = dot(area_, toNeighbour_), area2 = norm2(area_);
        const double widest2 = widestSquared(reach2, enough_);
        if (!(down > 0) || !(up > 0) || !(area2 >= widest2)) return false;
        const VecFour here = fourOf(p[0], p[1], p[2], p[3]);
        const VecFour next = picked<1, 2, 3, 0>(here), twice = cross(here, next), after = next - here;
        // Sizes and heights as in Apex::share(), both sides times the face's area.
        const double least2 = enough_ * enough_ / area2, down2 = least2 * down * down, up2 = least2 * up * up;
        const Vec3 across = toNeighbour_ - toOwner_;
        const double turn2 = (enough_ + leastTwist) * (enough_ + leastTwist) * norm2(across);
        const auto isSeen = [&](const VecFour& from, const VecFour& normal, const Four& size2) {
            const Four apart = dot(normal, from), above = apart - dot(normal, toOwner_), below = dot(normal, toNeighbour_) - apart;
            return (size2 >= widest2) & (above > 0) & (above * above >= down2 * size2) & (below > 0) & (below * below >= up2 * size2);
        };
        const Four size2 = dot(twice, twice), turn = dot(twice, across);
        const auto around = isSeen(here, twice, size2) & (turn > 0) & (turn * turn >= turn2 * size2) & (dot(cross(picked<3, 0, 1, 2>(after), after), area_) >= 0);
        if (!(around[0] & around[1] & around[2] & around[3])) return false;
        const VecFour from = picked<0, 0, 1, 1>(here); // both diagonals, each with its two triangles
        const VecFour fan = cross(picked<1, 2, 2, 3>(here) - from, picked<2, 3, 3, 0>(here) - from);
        const auto fans = isSeen(from, fan, dot(fan, fan));
        return (fans[0] & fans[1]) != 0 || (fans[2] & fans[3]) != 0;
    }

  private:
    Vec3 area_; // m^2
    double enough_;
    Vec3 toOwner_, toNeighbour_; // m; on the boundary as far beyond the face
};

class Face {
  public:
    Face(const PolyMesh& mesh, std::int32_t face, const Vec3& centre, const Vec3& area, const Vec3& owner, const Vec3* neighbour, double enough)
        : v_(mesh.face(face)), points_(mesh.points), centre_(centre), enough_(enough) {
        const Vec3 normal = normalized(area);
        apexes_[0] = {owner - centre, dot(normal, centre - owner)};
        if (neighbour) apexes_[count_++] = {*neighbour - centre, dot(normal, *neighbour - centre)};
        across_ = normalized((neighbour ? *neighbour : centre) - owner);
        for (Index i = 0; i < v_.size(); ++i) reach2_ = std::max(reach2_, norm2(at(i)));
        widest2_ = widestSquared(reach2_, enough);
    }
    bool isParallelogram() const {
        return v_.size() == 4 && norm2(at(0) - at(1) + at(2) - at(3)) <= flat2 * norm2(at(0) - at(2));
    }
    double width(const Vec3& area) const { return norm2(area) < widest2_ ? widthOf(area, reach2_, enough_) : enough_; }
    double aroundCentre(double hopeless) const {
        double worst = enough_;
        Vec3 here = at(0);
        for (Index i = 1; i <= v_.size() && worst > hopeless; ++i) {
            const Vec3 next = at(i), twice = cross(here, next);
            const double turn = shareBelow(enough_ + leastTwist, dot(twice, across_), norm2(twice));
            worst = std::min(worst, share(here, twice));
            if (turn < enough_ + leastTwist) worst = std::min(worst, turn - leastTwist);
            here = next;
        }
        return worst;
    }
    // What reflex corners leave of the turn that they may have; a turn of over 90 degrees has that more.
    double atCorners(const Vec3& area) const {
        double worst = enough_;
        const Index n = v_.size();
        Vec3 before = at(0) - at(n - 1);
        for (Index i = 0; i < n; ++i) {
            const Vec3 next = at(i + 1) - at(i), turn = cross(before, next);
            if (dot(turn, area) < 0) {
                const double sine = std::sqrt(norm2(turn) / (norm2(before) * norm2(next)));
                worst = std::min(worst, mostReflex - (dot(before, next) < 0 ? 2 - sine : sine));
            }
            before = next;
        }
        return worst;
    }
    double bestFan(double wanted) const {
        double best = least;
        for (Index base = 0; base < v_.size() && best < wanted; ++base) {
            const Vec3 from = at(base);
            double worst = enough_;
            for (Index i = 1; i + 1 < v_.size() && worst > best; ++i)
                worst = std::min(worst, share(from, cross(at(base + i) - from, at(base + i + 1) - from)));
            best = std::max(best, worst);
        }
        return best;
    }

  private:
    Vec3 at(Index i) const { return points_[Index(v_[i < v_.size() ? i : i - v_.size()])] - centre_; }
    double share(const Vec3& p, const Vec3& twice) const {
        double worst = width(twice);
        for (Index k = 0; k < count_; ++k) worst = std::min(worst, apexes_[k].share(p, twice, k == 0 ? 1 : -1, enough_));
        return worst;
    }

    std::span<const std::int32_t> v_;
    std::span<const Vec3> points_;
    Vec3 centre_, across_;
    double enough_, reach2_ = 0, widest2_ = 0; // m^2, m^4
    std::array<Apex, 2> apexes_;
    Index count_ = 1;
};

} // namespace

double tetShare(const PolyMesh& mesh, std::int32_t face, const Vec3& centre, const Vec3& area, const Vec3& owner, const Vec3* neighbour,
                double enough, double hopeless) {
    const auto v = mesh.face(face);
    const auto at = [&](Index i) { return mesh.points[Index(v[i])] - centre; };
    if (v.size() == 4 && QuadLook(centre, area, owner, neighbour, enough).isClear({at(0), at(1), at(2), at(3)})) return enough;
    if (v.size() == 3) return std::max(least, widthOf(area, std::max({norm2(at(0)), norm2(at(1)), norm2(at(2))}), enough));
    const Face f(mesh, face, centre, area, owner, neighbour, enough);
    const double width = f.width(area);
    if (f.isParallelogram()) return std::max(least, width);
    double share = std::min(width, f.aroundCentre(hopeless));
    if (share > hopeless) share = std::min(share, f.atCorners(area));
    if (share > hopeless) share = std::min(share, f.bestFan(share));
    return std::max(least, share);
}

} // namespace i2b
