// From the words of a command line to changes of a case.
#pragma once
#include "i2b/program/settings.h"
#include <functional>
#include <string>
#include <vector>

namespace i2b {

using Edit = std::function<void(Case&)>;

// Complains at once; what it gives is applied after the case file is read. Throws Error (usage).
Edit toEdit(const Setting& setting, const std::string& text);

// "--seed 0 -1 .5" becomes "--seed=0,-1,.5", and "--size -1" "--size=-1": no number is then taken for an
// option or a file, and --seed may take one text or three numbers without swallowing the geometry behind it.
std::vector<std::string> joinNumbers(const std::vector<std::string>& arguments);

} // namespace i2b
