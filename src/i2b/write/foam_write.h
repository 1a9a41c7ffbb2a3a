// PolyMesh as an OpenFOAM case (v1912's format; read by every later version and by ParaView).
//
//   constant/polyMesh/{points,faces,owner,neighbour,boundary[,cellZones]}   always, exchanged as a whole
//   system/{controlDict,fvSchemes,fvSolution}, case.foam                    only where the target has none
//
// Binary files are little-endian with 32-bit labels and doubles, faces as faceCompactList; text files hold
// the shortest digits that read back to the same double.
#pragma once
#include "i2b/assemble/poly_mesh.h"
#include "i2b/core/context.h"
#include "i2b/write/atomic_folder.h"
#include <string>
#include <vector>

namespace i2b {

struct FoamWriteOptions {
    bool ascii = false;    // text instead of binary
    bool caseFiles = true; // the minimal system/ and case.foam, too
    std::string note;      // for the files' headers: the program and its version; no quotes or line ends
};

// Writes into the folder's staging place; nothing shows under the final name before folder.commit().
// Throws Error{input} (unwritable, disk full, more than 2^31 labels) and Cancelled.
void writeFoam(const PolyMesh& mesh, AtomicFolder& folder, const FoamWriteOptions& options,
               const Context& context);

// Bytes that the binary polyMesh takes, but for some kB of headers.
std::uint64_t foamBytes(const PolyMesh& mesh);

// Names as OpenFOAM accepts them, in order: unfit characters become '_', repeated names get a number.
std::vector<std::string> foamNames(const std::vector<std::string>& names);

} // namespace i2b
