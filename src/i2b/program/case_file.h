// Case files: TOML whose keys are the options of the command line without their dashes.
//
//   geometry = ["body.stl", "wheels.obj"]
//   size = 0.01
//   seed = [{ name = "air", place = [0, 0, 2] }]    # or [0, 0, 2], or [[0, 0, 2], [1, 0, 2]]
//   part-size = [{ part = "wheel.*", size = 0.005 }]
//   box-size = [{ box = [0, -1, 0, 4, 1, 1], size = [0.02, 0.02, 0.01] }]   # one size, or one for each axis
//
// All sizes may stand in a table of their own instead, where surface is the size on the geometry:
//
//   [size]
//   surface = 0.01
//   buffer-cells = 4
//   [[size.band]]
//   part = "wheel.*"
//   distance = 0.1
//   size = 0.005
//
// So may features, where angle is feature-angle; files of lines are named relative to the case file, too:
//
//   [feature]
//   angle = 40
//   lines = ["edges.obj"]
//   part = ["door", "window.*"]
//   [[feature.box]]                     # the last one that holds a place decides there
//   box = [0, -1, 0, 4, 1, 1]
//   edges = "none"                      # or "all"
//
// And layers, where count, first, thickness, growth and unit are layers, first-layer, layer-thickness, growth and
// layer-unit; of a part, all but its name and count may be left out:
//
//   [layer]
//   count = 5
//   first = 0.001
//   [[layer.part]]                      # the last one that names a part decides there
//   part = "wheel.*"
//   count = 2                           # or "none"
//   growth = 1.3
#pragma once
#include "i2b/program/settings.h"
#include <string>
#include <string_view>

namespace i2b {

// Throws Error (usage) naming file, line and key: no such file, not TOML, an unknown key, a value of the
// wrong type.
Case readCaseFile(const std::string& path);
// As readCaseFile(), from text; path is for messages and for the folder that files are relative to.
Case parseCase(std::string_view text, const std::string& path);

// The complete case file: every key with its meaning. parseCase() of it gives the same options again.
std::string formatCase(const Case& given);

} // namespace i2b
