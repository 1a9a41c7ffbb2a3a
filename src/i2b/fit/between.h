// What lies between two places on the wall: the line in which they meet, be it a sharp edge of the soup, the line in
// which two parts cut each other, or the border between parts that lie flush.
#pragma once
#include "i2b/fit/features.h"

namespace i2b {

// What a wall node sees: its place on the geometry and the unit normal there, towards the fluid.
struct Foot {
    Vec3 point, normal;
    std::uint32_t part = 0; // of the geometry
    bool found = false;
};

// The nearest place on the geometry within radius (m) of q, seen from a place in the fluid.
Foot footAt(const SurfaceIndex& index, const Vec3& q, const Vec3& fluid, double radius);
// Of wall node b.
Foot footOf(const Band& band, const SurfaceIndex& index, const Positions& x, std::size_t b);

// Their normals differ by more than 25 degrees.
bool turns(const Foot& a, const Foot& b);

// Whether a place on the geometry is seen from one in the fluid: lines that end inside another part are not.
bool isSeen(const SurfaceIndex& index, const Vec3& fluid, const Vec3& place, double h);

struct Between {
    FeatureIndex::Line line;
    SnapKind kind = SnapKind::none;
    bool isOfBoth = true; // lies on both surfaces that it was looked for between, as far as these bend
};

// The feature between two feet that turn: a sharp edge of the soup, or else the line in which their tangent planes
// meet, if the geometry confirms it, or a crease. h: m, size of the cells around; fluid: a place in the fluid near by. intoHollows: also where the
// line is farther from the feet than these are apart.
Between lineBetween(const SurfaceIndex& index, const FeatureIndex& features, const Foot& a, const Foot& b, const Vec3& fluid, double h, bool intoHollows = false);

// The line in which the tangent planes of two feet meet, if the geometry confirms it, or the sharp edge that is there.
Between meetingOf(const SurfaceIndex& index, const FeatureIndex& features, const Foot& a, const Foot& b, const Vec3& fluid, double h);

// The feature at the foot of a riser, where its plane meets that of what it stands on: no other one near by.
Between lineUnder(const SurfaceIndex& index, const FeatureIndex& features, const Foot& ground, const Foot& riser, const Vec3& fluid, double h);

// A sharp edge that the way from one place on the wall to another leaves aside by more than a few hundredths of h, though the two do
// not turn: its sides bend back to each other within a cell.
Between lineOver(const SurfaceIndex& index, const FeatureIndex& features, const Vec3& a, const Vec3& b, const Vec3& fluid, double h);

// Where a line comes nearest to a segment: the share of the way from a to b, unlimited, and the place on the line.
double nearestOn(const FeatureIndex::Line& line, const Vec3& a, const Vec3& b, Vec3& place);

// The faint line (feature_index.h) that the way from one place on the wall to another leads over, where no other line runs near by.
Between faintBetween(const SurfaceIndex& index, const FeatureIndex& features, const Vec3& a, const Vec3& b, const Vec3& fluid, double h);

// The crease between two feet that do not turn, where the way from a to b leads over it, off the geometry, and no line is near by.
Between creaseBetween(const SurfaceIndex& index, const FeatureIndex& features, const Foot& footA, const Foot& footB, const Vec3& a, const Vec3& b,
                      const Vec3& fluid, double h);

// The border between two parts that lie flush, where it is seen from a place in the fluid; none where they lie upon each other.
Between borderBetween(const SurfaceIndex& index, const Foot& a, const Foot& b, const Vec3& fluid, double h);

// Whether another part than the foot's own comes as near as this to it.
bool hasOtherPartNear(const SurfaceIndex& index, const Foot& foot, double distance);

} // namespace i2b
