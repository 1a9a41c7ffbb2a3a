// Any OpenFOAM polyMesh as a PolyMesh: text or binary, plain or .gz, 32- or 64-bit labels and scalars as the
// header's arch entry says, faces as faceList or faceCompactList. cellZones are read where there are any;
// point and face zones and whatever else a patch's dictionary holds are not. Files are mapped, so the peak is
// the mesh itself and one file at a time.
#pragma once
#include "i2b/assemble/poly_mesh.h"
#include <string>

namespace i2b {

// folder: a case, or the polyMesh folder itself. Throws Error{input} that names the file and the line or
// byte. The mesh's index ranges are checked; whether its cells are closed and its faces in order is not
// (validate()).
PolyMesh readFoam(const std::string& folder);

} // namespace i2b
