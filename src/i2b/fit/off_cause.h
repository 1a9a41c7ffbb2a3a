// Why a wall node is not on the geometry: the causes that can be told apart, for reports and pictures.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

namespace i2b {

// The numbers are those in mesh.vtu and wall.ply. Where several would do, the first that is found in the order of
// findOffCauses() (off_wall.h) counts.
enum class OffCause : std::uint8_t {
    none = 0,         // on the geometry, or of no interest
    quality = 1,      // on its target a corner of its cells would fall below the floor, and nothing below explains why
    besideEdge = 2,   // the same, where the geometry folds within h and the node is not held to the fold
    feature = 3,      // held to a sharp edge, border or corner; on it a corner of its cells would fall below the floor
    featureOff = 4,   // on the line that it is held to, which is itself off the geometry there
    gap = 5,          // a sheet of the geometry faces it within two cells: a passage, slot or groove, bridged
    bridged = 6,      // over an opening in a sheet, narrower than two cells, with nothing behind; or no geometry within two cells
    sheetBetween = 7, // other geometry lies between it, or its front node, and its target
    boxSide = 8,      // in a side of the domain box, where the geometry does not reach that side or meets it too flat
    unfinished = 9,   // nothing that was looked at bars the way: the fit ended before
    retreated = 10,   // it was on the geometry, and repair pulled it back
    tilted = 11       // it is on the geometry, but a face at it is tilted by over 45 degrees
};
inline constexpr std::size_t offCauses = 12;

// As in report.json.
inline const char* nameOf(OffCause cause) {
    constexpr std::array<const char*, offCauses> names{"none",    "quality",       "beside_edge", "feature",    "feature_off", "gap",
                                                       "bridged", "sheet_between", "box_side",    "unfinished", "retreated",   "tilted"};
    return names[static_cast<std::size_t>(cause)];
}

} // namespace i2b
