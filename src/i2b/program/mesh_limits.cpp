#include "i2b/program/mesh_limits.h"
#include <algorithm>
#include <cmath>

namespace i2b {
namespace {

constexpr double enough = 0.05;     // of a regular pyramid's volume: a limit of less leaves room
constexpr double degenerate = 1e-3; // the same: what has less is no cell
constexpr double filled = 0.7;      // of a cell's size: height of layers that fill the room

// m, of the lowest cell at the wall.
double lowestCell(double smallest, const LayerPlan& plan) {
    if (plan.count == 0) return filled * smallest;
    if (!plan.fills()) return std::min(plan.firstAt(smallest), smallest);
    double sum = 0;
    for (int i = 0; i < plan.count; ++i) sum += std::pow(plan.growth, i);
    return filled * smallest / sum;
}

} // namespace

DictionaryLimits meshLimits(const DictionaryLimits& asked, double smallest, const std::vector<LayerPlan>& plans) {
    DictionaryLimits limits = asked;
    if (asked.pyramidVolume != DictionaryLimits{}.pyramidVolume) return limits;
    double height = smallest;
    for (const LayerPlan& plan : plans) height = std::min(height, lowestCell(smallest, plan));
    const double regular = smallest * smallest * height / 6; // over a face of the wall, to the middle of its cell
    if (limits.pyramidVolume > enough * regular) limits.pyramidVolume = degenerate * regular;
    return limits;
}

} // namespace i2b
