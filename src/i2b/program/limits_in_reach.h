// Limits of quality that a mesh of its kind can be brought within.
#pragma once
#include "i2b/assemble/poly_mesh.h"
#include "i2b/quality/dictionary_limits.h"
#include <string>
#include <vector>

namespace i2b {

struct LimitsInReach {
    DictionaryLimits limits;
    std::vector<std::string> givenUp; // of each limit that is not in reach: which, how many faces are beyond it, what is worked to instead
};

// The limits asked for, but fallback's for those stricter ones that more faces break than moves and changes of single cells mend:
// working to these would take long, and would harm what else there is to keep. mesh: before its repair.
LimitsInReach limitsInReach(const PolyMesh& mesh, const DictionaryLimits& asked, const DictionaryLimits& fallback);

} // namespace i2b
