// Small mesh builders of which the samples are made. Each returns a closed shell with outward normals (unless
// caps are left off), its points shared by index. Lengths in metres.
#pragma once
#include "i2b/samples/outline.h"
#include <functional>
#include <string>

namespace i2b::samples {

struct Mesh {
    std::vector<Vec3> points;
    std::vector<Triangle> triangles;
};

struct NamedPart {
    std::string name;
    Mesh mesh;
};

// A right-handed place in space: outlines are drawn in u, v and grow along w.
struct Frame {
    Vec3 origin;
    Vec3 u{1, 0, 0}, v{0, 1, 0}, w{0, 0, 1};
    Vec3 at(double a, double b, double c) const { return origin + a * u + b * v + c * w; }
};
Frame upright(const Vec3& origin);                      // u = x, v = y, w = z
Frame lengthwise(double x);                             // u = y, v = z, w = x: outlines drawn in (y, z)
Frame along(const Vec3& origin, const Vec3& direction); // w = direction; u, v any

struct Caps {
    bool start = true, end = true;
};

using Ring = std::vector<Vec3>; // counterclockwise about the direction of growth; one point: a pole
using Path = std::vector<Vec3>;
using Profile = std::vector<Vec2>; // (radius, height)

void append(Mesh& to, const Mesh& more);
Mesh moved(Mesh mesh, const Vec3& by);

// The skin over rings of equal count (or poles); flat caps on the first and last.
Mesh loft(const std::vector<Ring>& rings, Caps caps = {});

// Outline less holes, over rising levels along w (the holes' walls from first to last in one). Point l *
// outline.size() + i is outline point i at level l: see perforate().
Mesh extrude(const Frame& frame, const Loop2& outline, const std::vector<Loop2>& holes,
             const std::vector<double>& levels, Caps caps = {});

struct Section {
    Loop2 outline;
    double height = 0;
};
// Loft of sections of equal point count, in a frame: draft angles, fillets, flanges.
Mesh stack(const Frame& frame, const std::vector<Section>& sections, Caps caps = {});

// The profile turned about w: from the axis outwards and up and back to the axis, or counterclockwise and
// closed.
Mesh lathe(const Frame& frame, const Profile& profile, int n, bool closed = false);

Mesh box(const Vec3& lo, const Vec3& hi);

struct RoundedBox {
    Vec2 lo, hi; // footprint at the bottom, in u and v
    double bottom = 0, top = 0;
    double corner = 0.005; // radius of the upright edges
    double fillet = 0;     // radius of the top's rim, less than corner; 0: sharp
    double draft = 0;      // inwards per height
    int segments = 4;      // per quarter turn
};
std::vector<Section> sectionsOf(const RoundedBox& shape);
Mesh roundedBox(const Frame& frame, const RoundedBox& shape, Caps caps = {});

// Straight lines with round bends of the given radius at every inner corner, `segments` to each bend (made a
// power of two).
Path bentPath(const Path& corners, double radius, int segments);

// The outline carried along the path without twist, one ring a path point. `up`: where v points at the start,
// as far as it is square to the path. scale (optional): per path point.
std::vector<Ring> sweepRings(const Path& path, const Loop2& outline, const Vec3& up,
                             const std::vector<double>& scale = {});
Mesh sweep(const Path& path, const Loop2& outline, const Vec3& up = {0, 0, 1}, Caps caps = {});
Mesh pipe(const Path& path, double radius, int n, Caps caps = {});

// Takes the side wall of an extruded outline of n points between levels l0, l1 and outline points i0, i1 (i1
// may run past n) away and returns the rim of the hole, counterclockwise seen from outside.
std::vector<std::uint32_t> perforate(Mesh& mesh, std::size_t n, std::size_t l0, std::size_t l1,
                                     std::size_t i0, std::size_t i1);
// Grows a round pipe out of such a rim along the path, blending from the rim to the circle.
void growPipe(Mesh& mesh, const std::vector<std::uint32_t>& rim, const Path& path, double radius,
              bool capped);

// A hexagon bolt head standing on `origin`, `size` across, as long as 0.6 of it, and sunk by 0.2 of it.
Mesh boltHead(const Vec3& origin, const Vec3& direction, double size);

// Removes the triangles whose centre satisfies the condition.
void drop(Mesh& mesh, const std::function<bool(const Vec3& centre, const Vec3& normal)>& condition);

} // namespace i2b::samples
