// The one place where options are checked, before any stage sees them.
#pragma once
#include "i2b/options.h"
#include "i2b/program/settings.h"
#include <string>
#include <vector>

namespace i2b {

struct Problem {
    std::string key;    // of the option, as in a case file
    std::string text;   // what is wrong
    std::string remedy; // what to write instead
};

// Everything wrong with the options of mesh, grid and regions, in the order of the keys; empty if they are
// good. Whether files exist and hold geometry is for their readers to say.
std::vector<Problem> validate(const Options& options);

// Throws Error (usage) that names every problem and where its key was set.
void requireValid(const Case& given);

} // namespace i2b
