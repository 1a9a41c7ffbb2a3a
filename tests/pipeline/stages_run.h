// The stages of generate() one by one on a soup in memory, so that tests can look and take part in between.
#pragma once
#include "carve/kept_checks.h"
#include "i2b/assemble/assemble.h"
#include "i2b/fit/fit.h"
#include "i2b/samples/builder.h"
#include <memory>

namespace i2b::test {

// External flow around a soup of about 2 m at the origin, in a box of 4.8 m, cells of 0.1 m at the wall.
inline constexpr double stagesSize = 0.1;
Options stagesOptions();

void addPart(Surface& soup, const samples::Mesh& mesh, const char* name);

// A box of 2 x 1.6 x 1.2 m about the origin, turned by odd angles.
Surface turnedBox();
// A box of about that size along the axes, whose left and right half are parts 0 and 1. They lie flush: the border is where
// borderSide() is 0.
Surface flushHalves();
double borderSide(const Vec3& p); // m, signed
// A box of about that size along the axes with a plate of 1.3 x 0.9 m let into its top, turned by an odd angle about the z
// axis: part 1, which rises by so much above it and ends so deep in it, m. The corners of its outline on the top.
Surface plateInTop(double rise, double depth = 0.2);
std::array<Vec3, 4> plateFoot();
// The same box, turned itself, with a lid on its top that juts out by so much all round, m: part 1. The corners of the box's top.
Surface lidOnTop(double over);
std::array<Vec3, 4> lidFoot();
// A box of about that size along the axes whose top rises by 45 degrees along a strip so wide, m, and bends back to 10 degrees behind it.
// The ends of the sharp edge where it starts to rise.
Surface bentBack(double strip);
std::array<Vec3, 2> bentBackLine();

// Up to the front.
struct ToFront {
    ToFront(const Surface& soup, const Options& options);
    Painted painted;
    KeptCells kept;
    LatticeMesh lattice;
    Front front;
    FeatureGraph graph;
    FeatureIndex features;
};

// Up to the mesh, before repair.
struct ToMesh : ToFront {
    ToMesh(const Surface& soup, const Options& options);
    FitSummary fitted;
    LayerStack layers;
    PolyMesh mesh;
};

Vec3 wallPoint(const Front& front, std::size_t vertex);

// Divides edges of a front at random, as the fit does where they cross lines, and cuts the faces that two or more of the new
// vertices lie on from the first to the second. Needs a front that has none yet.
void divideAtRandom(Front& front, unsigned seed, double share);

} // namespace i2b::test
