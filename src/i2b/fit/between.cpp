#include "i2b/fit/between.h"
#include "i2b/fit/fit.h"
#include <algorithm>

namespace i2b {
namespace {

constexpr double degree = 3.14159265358979323846 / 180;
const double smallestTurn = std::cos(25 * degree);
const double confirmedTurn = std::cos(35 * degree);
constexpr double besideLine = 0.25; // of h: steps off a line along the planes that meet in it
constexpr double roundedOff = 0.25; // of h: so far from the geometry two planes may meet where an edge is rounded
constexpr double inCrack = 0.02;    // of h: so far from it a crack is one,
constexpr double asFar = 1.6;       // and either rim will do that is not so many times farther than the nearest
const double sameAsPlane = std::cos(8 * degree);
const Vec3 anyWay{0.267, 0.535, 0.802}; // the same everywhere, along no axis
constexpr double atMeeting = 0.1;   // of h: so near to where two planes meet a sharp edge is the one there
constexpr double offPlane = 0.1;    // sine: a line that is farther off the plane of a foot is that of another surface
constexpr double rimReach = 0.6;    // of h: so far from the feet the rim of a thin sheet is looked for,
const double foldedBack = std::cos(120 * degree); // where they stand on its two sides
constexpr double hollowReach = 2.2; // of h: and so far the line at the end of a hollow
constexpr double hiddenBy = 0.05;   // of h: so far behind what is seen a line is hidden
constexpr double flush = 0.15;      // of h: the way over a higher step,
constexpr double halfway = 0.1;     // of h: where it is so far off the geometry, changes parts halfway between its sides, not at a border
constexpr double aside = 0.04;      // of h: so far off the way a line is over it,
constexpr double alongWay = 0.7;    // cosine: if it does not run along it
constexpr double offWay = 0.15;     // of h: so far off the way a line that it leads over may be,
constexpr double alongWholly = 0.95; // cosine: if it does not all but run along it
constexpr double overGeometry = 0.05; // of h: a faint line may be so far off the geometry,
constexpr double faintApart = 0.5;  // if no other line comes so near to its place
constexpr double faintAside = 0.1;  // at least so far beside it
constexpr double offCrease = 0.01;  // of h: a way that comes nearer to a crease follows the geometry,
constexpr double creaseApart = 0.5; // and one so near to a line is left to that
constexpr double creaseReach = 0.5; // of the feet's distance: so near to the middle a crease parts feet whose planes do not meet,
constexpr float creaseFold = 15;    // degrees: if it folds by more
constexpr double creaseBeside = 0.2; // of h: and is so far from a line

// The place on the geometry for one where two planes meet: of a rounded edge the middle. Beside a crack both planes end as far
// away: all along it the rim of the same one, or the mesh would change sides from node to node. Normals are compared without their
// sign: from a place beyond the edge a plane is seen from behind.
ClosestPoint onGeometry(const SurfaceIndex& index, const Vec3& meeting, const Vec3& a, const Vec3& b, double h) {
    const ClosestPoint c = index.closest(meeting, roundedOff * h);
    if (!c || c.distance < inCrack * h) return c;
    const auto isOn = [&](std::uint32_t triangle, const Vec3& normal) { return std::abs(dot(index.normal(triangle), normal)) > sameAsPlane; };
    if (!isOn(c.triangle, a) && !isOn(c.triangle, b)) return c;
    const Vec3& chosen = std::abs(dot(a, anyWay)) > std::abs(dot(b, anyWay)) ? a : b;
    const ClosestPoint rim = index.closest(meeting, std::min(asFar * c.distance, roundedOff * h), [&](std::uint32_t t) { return isOn(t, chosen); });
    return rim ? rim : c;
}

// The line in which the tangent planes of two feet meet, looked at again on the geometry three times.
FeatureIndex::Line implicitLine(const SurfaceIndex& index, Foot a, Foot b, const Vec3& fluid, double h) {
    FeatureIndex::Line line;
    Vec3 middle = (a.point + b.point) * 0.5;
    for (int round = 0; round < 3; ++round) {
        const Vec3 t = cross(a.normal, b.normal);
        const double s = norm2(t);
        if (s < 0.15) return line; // planes within 23 degrees
        // Nearest point to the middle on both planes: middle + u na + v nb.
        const double c = dot(a.normal, b.normal), da = dot(a.normal, a.point - middle), db = dot(b.normal, b.point - middle);
        const Vec3 p = middle + a.normal * ((da - c * db) / s) + b.normal * ((db - c * da) / s);
        if (norm(p - (a.point + b.point) * 0.5) > 1.5 * h) return line;
        line.point = p;
        line.tangent = t / std::sqrt(s);
        // Step off the line along each plane, to the side of its own foot.
        const auto along = [&](const Foot& foot) {
            const Vec3 d = foot.point - p;
            const Vec3 inPlane = d - line.tangent * dot(d, line.tangent) - foot.normal * dot(d, foot.normal);
            return normalized(inPlane) * (besideLine * h);
        };
        const Foot na = footAt(index, p + along(a), fluid, h), nb = footAt(index, p + along(b), fluid, h);
        if (!na.found || !nb.found) return line;
        a = na, b = nb, middle = p;
    }
    const ClosestPoint on = onGeometry(index, line.point, a.normal, b.normal, h);
    if (on) line.point = on.point;
    line.found = on && dot(a.normal, b.normal) < confirmedTurn && isSeen(index, fluid, line.point, h);
    return line;
}

// Is a place of the geometry on the plane that a foot stands on, as far as surfaces bend?
bool liesOn(const Foot& foot, const Vec3& place, double h) {
    const Vec3 way = place - foot.point;
    return std::abs(dot(foot.normal, way)) < std::max(atMeeting * h, offPlane * norm(way));
}

// Where the nearest part changes on the way from a foot of one part to a place of another, and how far off that the way is;
// none if it does not.
bool partChange(const SurfaceIndex& index, const Foot& from, Vec3 to, double& off, Vec3& place) {
    const auto isOwn = [&](const Vec3& p) {
        const ClosestPoint c = index.closest(p);
        return c && static_cast<std::uint32_t>(index.surface().partOf[c.triangle]) == from.part;
    };
    if (isOwn(to)) return false;
    Vec3 own = from.point;
    for (int i = 0; i < 7; ++i) {
        const Vec3 middle = (own + to) * 0.5;
        (isOwn(middle) ? own : to) = middle;
    }
    const ClosestPoint change = index.closest((own + to) * 0.5);
    place = change.point, off = change.distance;
    return true;
}

// The line that the way from a to b leads over, at the share t of it.
template <class Closest>
FeatureIndex::Line lineUnderWay(const Closest& closest, const Vec3& a, const Vec3& b, double h, double& t) {
    const double length = norm(b - a);
    FeatureIndex::Line line = closest((a + b) * 0.5, 0.5 * length + offWay * h);
    for (int round = 0; line.found && round < 2; ++round) { // lines turn
        Vec3 place;
        t = nearestOn(line, a, b, place);
        if (std::abs(dot(line.tangent, b - a)) > alongWholly * length || !(t > 0 && t < 1)) return {};
        line = closest(a + (b - a) * t, offWay * h);
    }
    return line;
}

} // namespace

Foot footAt(const SurfaceIndex& index, const Vec3& q, const Vec3& fluid, double radius) {
    Foot foot;
    const ClosestPoint c = index.closest(q, radius);
    if (!c) return foot;
    foot.point = c.point;
    foot.normal = index.normal(c.triangle);
    foot.part = static_cast<std::uint32_t>(index.surface().partOf[c.triangle]);
    if (dot(foot.normal, fluid - c.point) < 0) foot.normal = -foot.normal;
    foot.found = foot.normal != Vec3{};
    return foot;
}

Foot footOf(const Band& band, const SurfaceIndex& index, const Positions& x, std::size_t b) {
    const Vec3 f = seenFront(index, band, b, x[static_cast<std::size_t>(band.frontNode[b])]);
    const Vec3 way = f - x[b];
    const double length = norm(way);
    const Vec3 q = length > 0 ? x[b] + way * std::min(1.0, 0.1 * band.h[b] / length) : x[b];
    return footAt(index, q, f, 2 * band.reach[b]);
}

bool isSeen(const SurfaceIndex& index, const Vec3& fluid, const Vec3& place, double h) {
    const double distance = norm(place - fluid);
    return distance <= hiddenBy * h || !index.firstHit(fluid, place, 1 - hiddenBy * h / distance);
}

bool turns(const Foot& a, const Foot& b) {
    const double c = dot(a.normal, b.normal);
    return a.found && b.found && c < smallestTurn;
}

Between lineBetween(const SurfaceIndex& index, const FeatureIndex& features, const Foot& a, const Foot& b, const Vec3& fluid, double h, bool intoHollows) {
    const double c = dot(a.normal, b.normal), apart = norm(a.point - b.point);
    const bool isRim = c < foldedBack, isHollow = dot(b.point - a.point, a.normal) > 0;
    double radius = 0.8 * apart;
    // Of two planes at an acute angle, halfway between feet as far from the line, which is farther than the feet are apart.
    if (intoHollows && isHollow && !isRim) radius = std::max(radius, std::min(1.2 * 0.5 * apart * std::sqrt((1 - c) / (1 + c)), hollowReach * h));
    if (isRim) radius = std::max(radius, rimReach * h);
    const FeatureIndex::Line line = features.closestLine((a.point + b.point) * 0.5, radius);
    if (line.found && isSeen(index, fluid, line.point, h)) return {line, SnapKind::line, isRim || (liesOn(a, line.point, h) && liesOn(b, line.point, h))};
    const FeatureIndex::Line implicit = implicitLine(index, a, b, fluid, h);
    if (implicit.found || !features.hasCreases()) return {implicit, SnapKind::implicitLine};
    // The sides do not go on as planes, as at a blunt edge: it may have a crease.
    const FeatureIndex::Line crease = features.closestCrease((a.point + b.point) * 0.5, creaseReach * apart, creaseFold);
    const bool isAlone = crease.found && !features.closestLine(crease.point, creaseBeside * h).found;
    return {isAlone && isSeen(index, fluid, crease.point, h) ? crease : implicit, SnapKind::implicitLine};
}

Between meetingOf(const SurfaceIndex& index, const FeatureIndex& features, const Foot& a, const Foot& b, const Vec3& fluid, double h) {
    const FeatureIndex::Line implicit = implicitLine(index, a, b, fluid, h);
    const FeatureIndex::Line sharp = implicit.found ? features.closestLine(implicit.point, atMeeting * h) : FeatureIndex::Line{};
    return sharp.found ? Between{sharp, SnapKind::line, false} : Between{implicit, SnapKind::implicitLine, false};
}

Between lineUnder(const SurfaceIndex& index, const FeatureIndex& features, const Foot& ground, const Foot& riser, const Vec3& fluid, double h) {
    const Vec3 down = cross(cross(ground.normal, riser.normal), riser.normal); // in the riser's plane, across the line
    const double slope = dot(ground.normal, down);
    if (slope == 0) return {};
    const Vec3 meeting = riser.point - down * (dot(ground.normal, riser.point - ground.point) / slope);
    const FeatureIndex::Line line = features.closestLine(meeting, atMeeting * h);
    if (line.found && isSeen(index, fluid, line.point, h)) return {line, SnapKind::line};
    return {implicitLine(index, ground, riser, fluid, h), SnapKind::implicitLine};
}

double nearestOn(const FeatureIndex::Line& line, const Vec3& a, const Vec3& b, Vec3& place) {
    const Vec3 d = b - a, w = a - line.point;
    const double dd = norm2(d), dt = dot(d, line.tangent), det = dd - dt * dt;
    const double t = det > 1e-6 * dd ? (dt * dot(w, line.tangent) - dot(w, d)) / det : 0.5;
    const Vec3 on = a + d * std::clamp(t, 0.0, 1.0);
    place = line.point + line.tangent * dot(on - line.point, line.tangent);
    return t;
}

Between lineOver(const SurfaceIndex& index, const FeatureIndex& features, const Vec3& a, const Vec3& b, const Vec3& fluid, double h) {
    const double length = norm(b - a);
    const FeatureIndex::Line line = features.closestLine((a + b) * 0.5, 0.5 * length);
    if (!line.found || std::abs(dot(line.tangent, b - a)) > alongWay * length) return {};
    Vec3 place;
    const double t = nearestOn(line, a, b, place);
    const Vec3 way = a + (b - a) * t;
    if (!(t > 0 && t < 1) || norm(way - place) < aside * h || index.closest(way, aside * h) || !isSeen(index, fluid, place, h)) return {};
    return {line, SnapKind::line};
}

Between faintBetween(const SurfaceIndex& index, const FeatureIndex& features, const Vec3& a, const Vec3& b, const Vec3& fluid, double h) {
    if (!features.hasFaint()) return {};
    double t = 0;
    const auto closest = [&](const Vec3& q, double radius) { return features.closestFaint(q, radius); };
    const FeatureIndex::Line line = lineUnderWay(closest, a, b, h, t);
    if (!line.found || !index.closest(line.point, overGeometry * h) || features.hasOtherBeside(line, faintApart * h, faintAside * h)) return {};
    if (!isSeen(index, fluid, line.point, h)) return {};
    return {line, SnapKind::line};
}

Between creaseBetween(const SurfaceIndex& index, const FeatureIndex& features, const Foot& footA, const Foot& footB, const Vec3& a, const Vec3& b,
                      const Vec3& fluid, double h) {
    if (!features.hasCreases() || !footA.found || !footB.found || dot(footA.normal, footB.normal) > features.creaseCosine()) return {};
    double t = 0;
    const auto closest = [&](const Vec3& q, double radius) { return features.closestCrease(q, radius); };
    const FeatureIndex::Line crease = lineUnderWay(closest, a, b, h, t);
    if (!crease.found || norm(crease.point - (a + (b - a) * t)) < offCrease * h || features.closestLine(crease.point, creaseApart * h).found) return {};
    if (!isSeen(index, fluid, crease.point, h)) return {};
    return {crease, SnapKind::implicitLine};
}

Between borderBetween(const SurfaceIndex& index, const Foot& a, const Foot& b, const Vec3& fluid, double h) {
    const auto isNear = [&](const Foot& foot, std::uint32_t part) {
        return bool(index.closest(foot.point, 0.05 * h, [&](std::uint32_t t) { return static_cast<std::uint32_t>(index.surface().partOf[t]) == part; }));
    };
    Between border;
    double off = 0;
    if (isNear(a, b.part) || isNear(b, a.part) || !partChange(index, a, b.point, off, border.line.point)) return border;
    if (!isSeen(index, fluid, border.line.point, h)) return border; // between surfaces that end inside another
    if (off > halfway * h && std::abs(dot(normalized(a.normal + b.normal), b.point - a.point)) > flush * h) return border;
    // The border's direction from a second place on it, a little to the side.
    const Vec3 across = normalized(cross(a.normal, b.point - a.point)) * (0.25 * h);
    Foot beside = a;
    beside.point += across;
    Vec3 second;
    border.line.tangent = normalized(across);
    if (partChange(index, beside, b.point + across, off, second) && norm(second - border.line.point) < h) border.line.tangent = normalized(second - border.line.point);
    border.line.found = border.line.tangent != Vec3{};
    border.kind = SnapKind::implicitLine;
    return border;
}

bool hasOtherPartNear(const SurfaceIndex& index, const Foot& foot, double distance) {
    return bool(index.closest(foot.point, distance, [&](std::uint32_t t) { return static_cast<std::uint32_t>(index.surface().partOf[t]) != foot.part; }));
}

} // namespace i2b
