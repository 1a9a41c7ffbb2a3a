// The limits of quality that a mesh is held to.
#pragma once
#include "i2b/layers/layer_plan.h"
#include "i2b/quality/dictionary_limits.h"
#include <vector>

namespace i2b {

// All but one are free of units. The least volume of a pyramid, 1e-13 m3 in OpenFOAM's dictionary, is meant for cells of a
// millimetre and more: where regular cells of the layers have hardly more, it asks for a thousandth of what they have. A figure
// that the user gives stays. smallest: m, edge of the smallest cell; plans: the layers, of all parts.
DictionaryLimits meshLimits(const DictionaryLimits& asked, double smallest, const std::vector<LayerPlan>& plans);

} // namespace i2b
