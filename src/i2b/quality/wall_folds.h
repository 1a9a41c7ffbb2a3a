// Where the wall of a mesh folds, as its sharp edges do.
#pragma once
#include "i2b/core/raw_vector.h"
#include "i2b/quality/fit_wall.h"

namespace i2b {

// m, n: area vectors of two faces at an edge, m^2. Do they fold by more than creaseAngle?
bool isCrease(const Vec3& m, const Vec3& n);

// An edge at which the wall ends, and a face of the boundary there that is none of the wall's, as of a side of the domain.
struct WallEnd {
    std::size_t edge;  // place in Wall::edges
    std::int32_t face; // of the mesh
    friend auto operator<=>(const WallEnd&, const WallEnd&) = default;
};
RawVector<WallEnd> endsOf(const PolyMesh& mesh, const Wall& wall);

// The edges where two faces of the wall fold by more, or one and that beside which it ends, as triangles without area. ends: endsOf().
Surface creaseSurface(const PolyMesh& mesh, const Wall& wall, const RawVector<WallEnd>& ends);

} // namespace i2b
