// Faults of the kinds that exported CAD has, put in on purpose; all of them deterministic.
#pragma once
#include "i2b/samples/builder.h"

namespace i2b::samples {

// Every `stride`-th triangle once more; every second copy the other way round.
void duplicateSome(Mesh& mesh, std::size_t stride);
// Every `stride`-th triangle the other way round; 1: the whole part.
void flipSome(Mesh& mesh, std::size_t stride);
// `count` triangles of no area: in turn a needle (three points on a line) and a point.
void addZeroArea(Mesh& mesh, std::size_t count);
// A sheet along a chain of the mesh's own points, standing off by the given vector: the chain's edges get a
// third triangle.
void addRib(Mesh& mesh, const std::vector<std::uint32_t>& chain, const Vec3& off);
// A slightly bent sheet over u, v in [0, 1]; sag in metres along w of the frame.
Mesh sheet(const Frame& frame, double width, double height, double sag, int nu, int nv);

} // namespace i2b::samples
