#include "i2b/quality/tet_quality.h"
#include "i2b/quality/measures.h"

namespace i2b {
namespace {

using Index = std::size_t;
constexpr double largestRadius = 1e15, beyondAll = 1e300;

// Volume over that of the regular tetrahedron in the same circumsphere; negative where inverted. With p, q, r
// the edges at a, the vector to the circumcentre is (|p|^2 q x r + |q|^2 r x p + |r|^2 p x q) / (2 p . q x
// r).
double tetQuality(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    const double regularVolume = 8.0 / (9.0 * std::sqrt(3.0)); // in the unit sphere
    const Vec3 p = b - a, q = c - a, r = d - a;
    const Vec3 pq = cross(p, q);
    const double sixfold = dot(pq, r);
    double radius = largestRadius;
    if (std::abs(sixfold) >= tinyDivisor) {
        const Vec3 toCentre = norm2(p) * cross(q, r) + norm2(q) * cross(r, p) + norm2(r) * pq;
        radius = std::min(radius, norm(toCentre) / (2 * std::abs(sixfold)));
    }
    return sixfold / 6 / (regularVolume * radius * radius * radius + tinyDivisor);
}

// The fan of triangles from vertex base, with its apex at the cell's centre: no tetrahedron at or below the
// tolerance? (Equivalent to: the least quality is over it.)
bool fanIsGood(const PolyMesh& mesh, std::span<const std::int32_t> v, Index base, const Vec3& apex,
               bool owner, const TetTolerance& tolerance) {
    const Vec3& p0 = mesh.points[Index(v[base])];
    double least = beyondAll;
    for (Index i = 1; i + 1 < v.size(); ++i) {
        const Vec3* a = &mesh.points[Index(v[(i + base) % v.size()])];
        const Vec3* b = &mesh.points[Index(v[(i + base + 1) % v.size()])];
        if (!owner) std::swap(a, b);
        const Vec3 e0 = p0 - apex, ea = *a - apex, eb = *b - apex;
        const int sign = tolerance.clearSign(dot(cross(e0, ea), eb), std::max({norm2(e0), norm2(ea), norm2(eb)}));
        if (sign < 0) return false;
        if (sign == 0) least = std::min(least, tetQuality(apex, p0, *a, *b));
        if (!(least > tolerance.quality)) return false;
    }
    return true;
}

// Does any vertex serve as base of a good fan, as seen from the owner and, inside the mesh, from the
// neighbour?
bool hasGoodBase(const PolyMesh& mesh, std::span<const std::int32_t> v, const Vec3& owner,
                 const Vec3* neighbour, const TetTolerance& tolerance) {
    for (Index base = 0; base < v.size(); ++base)
        if (fanIsGood(mesh, v, base, owner, true, tolerance) &&
            (neighbour == nullptr || fanIsGood(mesh, v, base, *neighbour, false, tolerance)))
            return true;
    return false;
}

// The tetrahedra over the triangles around the face's centre: is any not clearly on the apex's side? side is
// -1 for the owner, whose tetrahedra are negative, 1 for the neighbour.
bool hasBadTet(const PolyMesh& mesh, std::span<const std::int32_t> v, const Vec3& faceCentre,
               const Vec3& apex, int side, const TetTolerance& tolerance) {
    for (Index i = 0; i < v.size(); ++i) {
        const Vec3& a = mesh.points[Index(v[i])];
        const Vec3& b = mesh.points[Index(v[i + 1 == v.size() ? 0 : i + 1])];
        const Vec3 ab = b - a, ac = faceCentre - a, ad = apex - a;
        const int sign = tolerance.clearSign(dot(cross(ab, ac), ad), std::max({norm2(ab), norm2(ac), norm2(ad)}));
        if (sign == side) continue;
        if (sign == -side) return true;
        const double quality = tetQuality(a, b, faceCentre, apex);
        if (side > 0 ? quality < tolerance.quality : quality > -tolerance.quality) return true;
    }
    return false;
}

// A glance at all tetrahedra of a face at once: are those over the triangles around its centre, and those of
// the fan from its first vertex, all clearly on their cell's side? Then the face has no errors. No edge of
// such a tetrahedron is longer than twice the larger of the reaches from the face's centre to its vertices
// and to the apex. Worked out from the centre, so that both sides share the cross products.
bool tetsClearlyGood(const PolyMesh& mesh, std::span<const std::int32_t> v, const Vec3& faceCentre,
                     const Vec3& owner, const Vec3* neighbour, const TetTolerance& tolerance) {
    const Vec3 toOwner = owner - faceCentre;
    const Vec3 toNeighbour = neighbour != nullptr ? *neighbour - faceCentre : -toOwner;
    double reach2 = std::max(norm2(toOwner), norm2(toNeighbour));
    double least = beyondAll; // of the sixfold volumes
    const Vec3 first = mesh.points[Index(v[0])] - faceCentre;
    Vec3 here = first;
    for (Index i = 1; i <= v.size(); ++i) {
        const Vec3 next = i == v.size() ? first : mesh.points[Index(v[i])] - faceCentre;
        reach2 = std::max(reach2, norm2(next));
        const Vec3 area = cross(here, next);
        least = std::min(least, std::min(-dot(area, toOwner), dot(area, toNeighbour)));
        if (i > 1 && i < v.size()) {
            const Vec3 fan = cross(here - first, next - first);
            least = std::min(least, std::min(dot(fan, first - toOwner), dot(fan, toNeighbour - first)));
        }
        here = next;
    }
    return least > 0 && tolerance.clearSign(least, 4 * reach2) > 0;
}

} // namespace

int tetErrors(const PolyMesh& mesh, std::span<const std::int32_t> v, const Vec3& faceCentre,
              const Vec3& owner, const Vec3* neighbour, const TetTolerance& tolerance) {
    if (tolerance.quality >= 0 && tetsClearlyGood(mesh, v, faceCentre, owner, neighbour, tolerance)) return 0;
    int errors = hasBadTet(mesh, v, faceCentre, owner, -1, tolerance) ? 1 : 0;
    if (neighbour != nullptr && hasBadTet(mesh, v, faceCentre, *neighbour, 1, tolerance)) ++errors;
    if (!hasGoodBase(mesh, v, owner, neighbour, tolerance)) ++errors;
    return errors;
}

} // namespace i2b
