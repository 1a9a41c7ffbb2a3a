// An aircraft of structured surface patches, as PLOT3D files have them: each patch a block of points over two parameters,
// and every patch a part. Clean, patches that share a border share its points. Dirty, each patch has its own counts of
// points and runs over its border or stops short of it by a fraction of its own cell.
#include "i2b/samples/parts.h"

namespace i2b::samples {
namespace {

struct Range {
    double from = 0, to = 1;
};

// How far a dirty patch ends beyond its borders (or short of them: negative), in its own cells.
struct Slack {
    double u0 = 0, u1 = 0, v0 = 0, v1 = 0;
};

// A patch's counts of cells when dirty; clean, all patches along a border take that border's count.
struct Cells {
    int dirtyU, dirtyV, cleanU, cleanV;
};

struct Patch {
    Cells cells;
    Range u, v;
    Slack slack = {};
};

// At a pole, or where two faces meet in one edge, a side of the block has no length.
bool isCollapsed(const Mesh& mesh, const Triangle& t) {
    const Vec3 &a = mesh.points[t[0]], &b = mesh.points[t[1]], &c = mesh.points[t[2]];
    return std::min({norm2(b - a), norm2(c - b), norm2(a - c)}) < 1e-20;
}

// Points over u and v, every quadrangle as two triangles.
template <class Point>
Mesh structured(const Make& make, const Patch& patch, const Point& point) {
    const int nu = make.n(make.dirty() ? patch.cells.dirtyU : patch.cells.cleanU);
    const int nv = make.n(make.dirty() ? patch.cells.dirtyV : patch.cells.cleanV);
    const double more = make.dirty() ? std::min(make.dirt, 5.0) : 0; // never so much that a patch turns over
    const double du = more * (patch.u.to - patch.u.from) / nu, dv = more * (patch.v.to - patch.v.from) / nv;
    const Range u{patch.u.from - du * patch.slack.u0, patch.u.to + du * patch.slack.u1};
    const Range v{patch.v.from - dv * patch.slack.v0, patch.v.to + dv * patch.slack.v1};
    Mesh mesh;
    for (int j = 0; j <= nv; ++j)
        for (int i = 0; i <= nu; ++i) {
            // From both ends, so that each end is hit to the last bit.
            const double a = double(i) / nu, b = double(j) / nv;
            mesh.points.push_back(point(u.from * (1 - a) + u.to * a, v.from * (1 - b) + v.to * b));
        }
    const auto row = std::uint32_t(nu + 1);
    for (std::uint32_t j = 0; j < std::uint32_t(nv); ++j)
        for (std::uint32_t i = 0; i < std::uint32_t(nu); ++i) {
            const std::uint32_t a = j * row + i;
            for (const Triangle& t : {Triangle{a, a + 1, a + row + 1}, {a, a + row + 1, a + row}})
                if (!isCollapsed(mesh, t)) mesh.triangles.push_back(t);
        }
    return mesh;
}

// ---- body: u along x, v in turns about it from the port side (+y) over the top

constexpr double radius = 0.12, noseEnd = 0.45, tailStart = 1.3, length = 2.0;

double bodyRadius(double x) {
    if (x < noseEnd) {
        const double s = 1 - std::max(x, 0.0) / noseEnd;
        return radius * std::sqrt(std::max(0.0, 1 - s * s));
    }
    const double s = std::max(0.0, (x - tailStart) / (length - tailStart));
    return radius * (1 - 0.8 * s * s);
}

Vec3 aroundBody(double x, double r, double turns) {
    constexpr int fine = 1 << 20;
    const Vec2 e = unitCircle(int(std::floor(turns * fine + 0.5)), fine);
    return {x, r * e.x, r * e.y};
}

void addBody(Parts& parts, const Make& make) {
    const auto skin = [](double x, double turns) { return aroundBody(x, bodyRadius(x), turns); };
    // Points gather at the nose's tip, where its radius grows as a root.
    const auto nose = [&](double s, double turns) { return skin(noseEnd * s * std::abs(s), turns); };
    const auto base = [&](double s, double turns) { return aroundBody(length, s * bodyRadius(length), turns); };
    const auto add = [&](const char* name, const Patch& patch, const auto& point) {
        parts.push_back({name, structured(make, patch, point)});
    };
    add("nose", {{14, 30, 14, 36}, {0, 1}, {0, 1}, {0, -0.04, 0, 0}}, nose);
    add("barrel_top", {{24, 18, 24, 18}, {noseEnd, tailStart}, {0, 0.5}, {0, 0.03, 0.03, -0.02}}, skin);
    add("barrel_bottom", {{20, 14, 24, 18}, {noseEnd, tailStart}, {0.5, 1}, {0.02, 0.02, 0, -0.02}}, skin);
    add("tail", {{16, 26, 16, 36}, {tailStart, length}, {0, 1}, {-0.02, 0, 0, 0.03}}, skin);
    add("base", {{3, 20, 3, 36}, {0, 1}, {0, 1}, {0, 0.05, 0, 0}}, base);
}

// ---- lifting surfaces: u along the chord, v along the span

// Half the thickness of a NACA four-digit section of thickness 1, its trailing edge closed.
double halfThickness(double x) {
    return 5 * (0.2969 * std::sqrt(x) + x * (-0.1260 + x * (-0.3516 + x * (0.2843 + x * -0.1036))));
}

// Of one wing, or the fin; side -1 and 1 are its lower and upper face. In a frame of its own: chord along x, span
// along y, thickness along z.
struct Wing {
    Vec3 root, tip;                   // m, leading edges
    double rootChord, tipChord;       // m
    double rootThick, tipThick;       // of the chord
    Vec3 at(double s, double v, double side) const { // s: root of the place on the chord, so that points gather in front
        const double chord = rootChord + (tipChord - rootChord) * v, x = s * s;
        const double z = side * chord * (rootThick + (tipThick - rootThick) * v) * halfThickness(x);
        return root + (tip - root) * v + Vec3{chord * x, 0, z};
    }
};

constexpr double stripEnd = 0.25; // in s: the patch around the leading edge

void addWing(Parts& parts, const Make& make, const std::string& name, const Wing& wing) {
    const auto upper = [&](double s, double v) { return wing.at(s, v, 1); };
    const auto lower = [&](double s, double v) { return wing.at(s, v, -1); };
    const auto strip = [&](double s, double v) { return wing.at(std::abs(s), v, s < 0 ? -1 : 1); };
    const auto cap = [&](double s, double t) {
        return wing.at(s, 1, 1) * t + wing.at(s, 1, -1) * (1 - t);
    };
    const auto add = [&](const char* place, const Patch& patch, const auto& point) {
        parts.push_back({name + place, structured(make, patch, point)});
    };
    add("_upper", {{22, 20, 20, 20}, {stripEnd, 1}, {0, 1}, {0.1, 0, 0, 0}}, upper);
    add("_lower", {{16, 14, 20, 20}, {stripEnd, 1}, {0, 1}, {-0.2, 0, 0, -0.01}}, lower);
    add("_leading", {{12, 26, 12, 20}, {-stripEnd, stripEnd}, {0, 1}, {0, 0.05, 0, 0.01}}, strip);
    // Clean, as many cells in front of the strip's end as half the strip has.
    add("_tip", {{18, 3, 6, 1}, {0, stripEnd}, {0, 1}, {0, 0, 0, 0}}, cap);
    append(parts.back().mesh, structured(make, {{14, 3, 20, 1}, {stripEnd, 1}, {0, 1}, {0, 0, 0.05, -0.05}}, cap));
}

Mesh mirrored(Mesh mesh) {
    for (Vec3& p : mesh.points) p.y = -p.y;
    for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
    return mesh;
}

} // namespace

Parts wingBodyParts(const Make& make) {
    Parts parts;
    addBody(parts, make);
    // Both roots lie open inside the body.
    Parts port;
    addWing(port, make, "wing", {{0.70, 0.05, -0.04}, {1.05, 0.95, 0.02}, 0.46, 0.18, 0.13, 0.10});
    for (const NamedPart& p : port) parts.push_back({"port_" + p.name, p.mesh});
    for (const NamedPart& p : port) parts.push_back({"starboard_" + p.name, mirrored(p.mesh)});
    Parts fin;
    addWing(fin, make, "fin", {{1.55, 0.04, 0}, {1.82, 0.42, 0}, 0.34, 0.16, 0.10, 0.10});
    for (NamedPart& p : fin) {
        for (Vec3& q : p.mesh.points) q = {q.x, -q.z, q.y}; // a quarter turn about x: the span upwards
        parts.push_back(p);
    }
    return parts;
}

} // namespace i2b::samples
