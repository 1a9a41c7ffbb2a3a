#include "pipeline/shapes.h"
#include "i2b/samples/dirt.h"
#include "i2b/samples/sample.h"
#include "pipeline/polyhedra.h"
#include <numbers>

namespace i2b::test {
namespace {

using namespace samples;
using Line = std::array<Vec3, 2>;

ShapeGeometry geometryOf(const std::vector<Mesh>& parts) {
    ShapeGeometry g;
    for (const Mesh& part : parts) {
        const auto base = static_cast<std::uint32_t>(g.soup.points.size());
        const auto id = static_cast<std::int32_t>(g.soup.parts.size());
        g.soup.points.insert(g.soup.points.end(), part.points.begin(), part.points.end());
        for (const Triangle& t : part.triangles)
            g.soup.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
        g.soup.partOf.resize(g.soup.triangles.size(), id);
        g.soup.parts.push_back({"part" + std::to_string(id + 1), "", part.triangles.size()});
    }
    return g;
}

// ---- lines where triangles of different parts cross

std::array<Vec3, 3> cornersOf(const Surface& s, std::size_t t) {
    return {s.points[s.triangles[t][0]], s.points[s.triangles[t][1]], s.points[s.triangles[t][2]]};
}

// Where the edges of triangle a pass through triangle b.
void addPassages(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b, std::vector<Vec3>& places) {
    const Vec3 n = cross(b[1] - b[0], b[2] - b[0]);
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 &p = a[k], &q = a[(k + 1) % 3];
        const double dp = dot(n, p - b[0]), dq = dot(n, q - b[0]);
        if ((dp > 0) == (dq > 0)) continue;
        const Vec3 x = p + (q - p) * (dp / (dp - dq));
        bool within = true;
        for (std::size_t i = 0; i < 3; ++i)
            within &= dot(n, cross(b[(i + 1) % 3] - b[i], x - b[i])) >= -1e-12 * norm2(n);
        if (within) places.push_back(x);
    }
}

void addCrossings(ShapeGeometry& g) {
    const Surface& s = g.soup;
    for (std::size_t i = 0; i < s.triangles.size(); ++i)
        for (std::size_t j = i + 1; j < s.triangles.size(); ++j) {
            if (s.partOf[i] == s.partOf[j]) continue;
            std::vector<Vec3> places;
            addPassages(cornersOf(s, i), cornersOf(s, j), places);
            addPassages(cornersOf(s, j), cornersOf(s, i), places);
            Line longest{};
            for (const Vec3& p : places)
                for (const Vec3& q : places)
                    if (norm(q - p) > norm(longest[1] - longest[0])) longest = {p, q};
            if (norm(longest[1] - longest[0]) > 1e-9) g.lines.push_back(longest);
        }
}

ShapeGeometry crossing(const std::vector<Mesh>& parts) {
    ShapeGeometry g = geometryOf(parts);
    addCrossings(g);
    return g;
}

// ---- boxes, prisms, turned and extruded bodies

Mesh centredBox(const Vec3& size) { return box(size * -0.5, size * 0.5); }

Mesh turned(Mesh mesh, const Vec3& axis, double angle) {
    const Vec3 k = normalized(axis);
    for (Vec3& p : mesh.points)
        p = p * std::cos(angle) + cross(k, p) * std::sin(angle) + k * (dot(k, p) * (1 - std::cos(angle)));
    return mesh;
}

Mesh rod(double radius, double height, int n) {
    return lathe(upright({0, 0, -height / 2}), {{0, 0}, {radius, 0}, {radius, height}, {0, height}}, n);
}

Mesh prism(const Loop2& outline, double height) {
    return extrude(upright({}), outline, {}, {-height / 2, height / 2});
}

ShapeGeometry boxShape(double) { return geometryOf({centredBox({1.2, 0.9, 0.7})}); }
ShapeGeometry cylinder(double) { return geometryOf({rod(0.5, 1.1, 96)}); }
ShapeGeometry cone(double) {
    return geometryOf({lathe(upright({0, 0, -0.5}), {{0, 0}, {0.6, 0}, {0, 1.1}}, 96)});
}

ShapeGeometry step(double) {
    return geometryOf({prism({{-0.6, -0.5}, {0.6, -0.5}, {0.6, 0}, {0.1, 0}, {0.1, 0.5}, {-0.6, 0.5}}, 0.9)});
}

ShapeGeometry crossedBoxes(double) {
    return crossing({centredBox({1.2, 0.6, 0.5}),
                     moved(turned(centredBox({0.5, 0.55, 1.1}), {1, 2, 0.5}, 0.5), {0.05, 0.1, 0.1})});
}

ShapeGeometry pipeTee(double) {
    Mesh branch = turned(rod(0.25, 0.8, 64), {0, 1, 0}, std::numbers::pi / 2);
    return crossing({rod(0.4, 1.4, 96), moved(branch, {0.45, 0, 0.1})});
}

ShapeGeometry wedge(double) {
    const double half = std::tan(std::numbers::pi / 18) * 1.2; // 20 degrees between its sides
    return geometryOf({prism({{-0.6, 0}, {0.6, -half}, {0.6, half}}, 1.0)});
}

ShapeGeometry gearShape(double) {
    return geometryOf({extrude(upright({}), gear({}, 0.62, 0.86, 10), {circle({}, 0.25, 48)}, {-0.2, 0.2})});
}

ShapeGeometry helicalGear(double) {
    std::vector<Ring> rings;
    for (int k = 0; k <= 8; ++k) { // a turn of 15 degrees over the width
        const double a = std::numbers::pi / 12 * k / 8;
        Ring& ring = rings.emplace_back();
        for (const Vec2& p : gear({}, 0.6, 0.86, 8))
            ring.push_back({p.x * std::cos(a) - p.y * std::sin(a), p.x * std::sin(a) + p.y * std::cos(a), -0.25 + 0.0625 * k});
    }
    return geometryOf({loft(rings)});
}

// ---- thin things and dirt

ShapeGeometry halfCellSlab(double h) { return geometryOf({centredBox({1.2, 0.9, 0.5 * h})}); }

void addRim(ShapeGeometry& g, const std::vector<Vec3>& rim, bool closed) {
    for (std::size_t k = 0; k + (closed ? 0 : 1) < rim.size(); ++k)
        g.lines.push_back({rim[k], rim[(k + 1) % rim.size()]});
}

// Both sides of it, as a solid whose thickness was lost.
ShapeGeometry plate(double) {
    const std::vector<Vec3> rim{{-0.6, -0.45, 0}, {0.6, -0.45, 0}, {0.6, 0.45, 0}, {-0.6, 0.45, 0}};
    Mesh mesh{rim, {{0, 1, 2}, {0, 2, 3}, {0, 2, 1}, {0, 3, 2}}};
    ShapeGeometry g = geometryOf({mesh});
    addRim(g, rim, true);
    return g;
}

// A bent sheet that grows out of a block and ends in the flow on three sides.
ShapeGeometry freeSheet(double) {
    constexpr int n = 24;
    std::vector<Vec3> first, last;
    for (int i = 0; i <= n; ++i) {
        const double a = 1.0 * i / n;
        const Vec3 p{-0.45 + a, 0.25 * a * a, 0};
        first.push_back(p + Vec3{0, 0, -0.35}), last.push_back(p + Vec3{0, 0, 0.35});
    }
    Mesh sheet{first, {}};
    sheet.points.insert(sheet.points.end(), last.begin(), last.end());
    for (std::uint32_t i = 0; i < n; ++i) {
        sheet.triangles.push_back({i, i + 1, i + n + 2});
        sheet.triangles.push_back({i, i + n + 2, i + n + 1});
    }
    ShapeGeometry g = crossing({moved(centredBox({0.45, 0.6, 0.9}), {-0.5, 0, 0}), sheet});
    addRim(g, first, false), addRim(g, last, false);
    g.lines.push_back({first.back(), last.back()});
    return g;
}

Mesh ball(double radius) {
    const Surface s = makeSample("sphere");
    Mesh mesh{s.points, {}};
    for (const auto& t : s.triangles) mesh.triangles.push_back(t);
    for (Vec3& p : mesh.points) p *= 2 * radius;
    return mesh;
}

ShapeGeometry nestedSpheres(double h) {
    const double outer = 0.9, gap = 3.5 * h; // what lies between is meshed, and what is within
    ShapeGeometry g = geometryOf({ball(outer), ball(outer - gap)});
    g.seeds = {{"shell", {outer - gap / 2, 0, 0}}, {"core", {0, 0, 0}}};
    return g;
}

// Six faces, each 0.1 cells short of the edges: 0.2 cells of skin are missing along every edge. Its line is the crack's
// middle, 0.07 cells from either rim and from the edge that the two planes would have.
ShapeGeometry crackedCube(double h) {
    const double half = 0.5, shrunk = half - 0.1 * h;
    std::vector<Mesh> faces;
    ShapeGeometry lines;
    for (int axis = 0; axis < 3; ++axis)
        for (const double side : {-half, half}) {
            Vec3 n, u, v;
            n[axis] = side, u[(axis + 1) % 3] = shrunk, v[(axis + 2) % 3] = shrunk;
            faces.push_back({{n - u - v, n + u - v, n + u + v, n - u + v}, {{0, 1, 2}, {0, 2, 3}}});
            for (const double other : {-1.0, 1.0}) { // cracks along v: each of the twelve comes up once
                const Vec3 middle = n * ((half + shrunk) / (2 * half)) + u * (other * (half + shrunk) / (2 * shrunk));
                lines.lines.push_back({middle - v, middle + v});
                const Vec3 own = n + u * other, others = n * (shrunk / half) + u * (other * half / shrunk);
                lines.rims.push_back({{{own - v, own + v}, {others - v, others + v}}});
            }
        }
    ShapeGeometry g = geometryOf(faces);
    g.lines = lines.lines, g.rims = lines.rims;
    return g;
}

// ---- polyhedra

ShapeGeometry tetrahedron(double) {
    return geometryOf({fitted(polyhedron(signedPermutations({1, 1, 1}, true)), 0.95)});
}
ShapeGeometry rhombicDodecahedron(double) {
    return geometryOf({fitted(polyhedron(signedPermutations({1, 1, 0})), 0.8)});
}
ShapeGeometry deltoidalIcositetrahedron(double) {
    return geometryOf({fitted(polyhedron(signedPermutations({1, 1, 1 + std::sqrt(2.0)})), 0.9)});
}
ShapeGeometry triakisTetrahedron(double) {
    return geometryOf({fitted(polyhedron(signedPermutations({3, 1, 1}, true)), 0.9)});
}
ShapeGeometry stellaOctangula(double) {
    return geometryOf({fitted(stellated(signedPermutations({1, 1, 1})), 0.95)});
}
ShapeGeometry twoTetrahedra(double) { // the same star, of two bodies that cross
    Mesh one = fitted(polyhedron(signedPermutations({1, 1, 1}, true)), 0.95), other = one;
    for (Vec3& p : other.points) p = -p;
    return crossing({one, other});
}
ShapeGeometry smallStellatedDodecahedron(double) {
    return geometryOf({fitted(stellated(icosahedronVertices()), 0.98)});
}

} // namespace

const std::vector<Shape>& shapes() {
    static const std::vector<Shape> table{
        {"box", Side::both, boxShape},
        {"cylinder", Side::both, cylinder},
        {"cone", Side::both, cone},
        {"step", Side::both, step},
        {"crossed-boxes", Side::outside, crossedBoxes},
        {"pipe-tee", Side::outside, pipeTee},
        {"wedge-20", Side::both, wedge},
        {"half-cell-slab", Side::outside, halfCellSlab},
        {"plate", Side::outside, plate},
        {"free-sheet", Side::outside, freeSheet},
        {"nested-spheres", Side::inside, nestedSpheres},
        {"cracked-cube", Side::both, crackedCube},
        {"tetrahedron", Side::both, tetrahedron},
        {"rhombic-dodecahedron", Side::both, rhombicDodecahedron},
        {"deltoidal-icositetrahedron", Side::both, deltoidalIcositetrahedron},
        {"triakis-tetrahedron", Side::both, triakisTetrahedron},
        {"stella-octangula", Side::both, stellaOctangula},
        {"two-tetrahedra", Side::outside, twoTetrahedra},
        {"small-stellated-dodecahedron", Side::both, smallStellatedDodecahedron},
        {"gear", Side::both, gearShape},
        {"helical-gear", Side::both, helicalGear},
    };
    return table;
}

} // namespace i2b::test
