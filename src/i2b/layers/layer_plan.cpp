#include "i2b/layers/layer_plan.h"
#include "i2b/layers/y_plus.h"
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace i2b {
namespace {

constexpr double leastTransition = 0.5; // of the height of the last layer
constexpr double wantedTransition = 1;  // the same
constexpr double mostTransition = 3;    // times as high as the cell before
constexpr double sameEnough = 0.01;     // three figures that agree as well do not contradict each other

// Changes first and growth so that n layers and a cell of `extra` times the last one's height fill `height`.
void fit(double& first, double& growth, int n, double height, double extra) {
    const double lo = std::min(1.0, growth), hi = std::max(growth, mostGrowth);
    growth = solveGrowth(first, height, n, lo, hi, extra);
    const double now = stackHeight(first, growth, n) + extra * first * std::pow(growth, n - 1);
    if (now > height) first *= height / now; // even growth 1 does not do
}

// r for which r + r^2 + ... + r^n = sum, by Newton's method: from above on a rising curve that bends up it never steps past.
double ratioOf(double sum, int n) {
    double r = std::pow(sum, 1.0 / n);
    for (int i = 0; i < 40; ++i) {
        double value = 0, slope = 0;
        for (int k = 0; k < n; ++k) slope = slope * r + value + 1, value = (value + 1) * r; // of the sum of 1 to r^k, times r
        const double step = (value - sum) / slope;
        r -= step;
        if (!(step > 1e-13 * r)) break;
    }
    return r;
}

} // namespace

double LayerPlan::room() const {
    if (count == 0 || fills()) return 0;
    return stackHeight(first, growth, count) + wantedTransition * first * std::pow(growth, count - 1);
}

double stackHeight(double first, double ratio, int n) {
    double sum = 0, h = first;
    for (int i = 0; i < n; ++i, h *= ratio) sum += h;
    return sum;
}

double solveGrowth(double first, double height, int n, double lo, double hi, double extra) {
    const auto heightAt = [&](double r) { return stackHeight(first, r, n) + extra * first * std::pow(r, n - 1); };
    if (heightAt(hi) <= height) return hi;
    if (heightAt(lo) >= height) return lo;
    for (int i = 0; i < 52; ++i) {
        const double mid = 0.5 * (lo + hi);
        (heightAt(mid) < height ? lo : hi) = mid;
    }
    return 0.5 * (lo + hi);
}

LayerRequest requestOf(const LayerOptions& options) {
    LayerRequest r{options.count, options.first, options.thickness, options.growth};
    if (options.yPlus > 0) r.first = firstHeightOf(options.yPlus, options.velocity, options.viscosity, options.length);
    return r;
}

LayerRequest requestOf(const LayerOptions& options, const PartLayers& part) {
    const LayerRequest all = requestOf(options);
    LayerRequest r{part.count, part.first, part.thickness, part.growth};
    const auto given = [&] { return (r.first > 0) + (r.thickness > 0) + (r.growth > 0); };
    if (r.first == 0 && given() < 2) r.first = all.first;
    if (r.growth == 0 && given() < 2) r.growth = all.growth;
    if (r.thickness == 0 && given() < 2) r.thickness = all.thickness;
    return r;
}

std::string faultOf(const LayerRequest& r) {
    if (r.count == 0 || r.first == 0 || r.thickness == 0) return "";
    if (r.growth > 0 || r.count == 1) {
        const double sum = stackHeight(r.first, r.growth, r.count);
        if (std::abs(sum - r.thickness) <= sameEnough * r.thickness) return "";
        return fmt::format("{} layers that begin with {} and grow by {} are {:.4g} thick, not {}", r.count, r.first,
                           r.growth > 0 ? r.growth : 1, sum, r.thickness);
    }
    const double least = stackHeight(r.first, leastGrowth, r.count), most = stackHeight(r.first, mostGrowth, r.count);
    if (r.thickness >= least && r.thickness <= most) return "";
    return fmt::format("{} layers that begin with {} and grow by {} to {} are {:.4g} to {:.4g} thick, not {}", r.count, r.first,
                       leastGrowth, mostGrowth, least, most, r.thickness);
}

LayerPlan planOf(const LayerRequest& r, LayerUnit unit) {
    LayerPlan plan;
    plan.count = r.count;
    plan.relative = unit == LayerUnit::cell;
    plan.first = r.first;
    if (r.growth > 0) {
        plan.growth = r.growth;
    } else if (r.first > 0 && r.thickness > 0 && r.count > 1) {
        plan.growth = solveGrowth(r.first, r.thickness, r.count, leastGrowth, mostGrowth);
    }
    if (r.first == 0 && r.thickness > 0 && r.count > 0) plan.first = r.thickness / stackHeight(1, plan.growth, r.count);
    return plan;
}

double askedFirst(const LayerPlan& plan, double room, double cellSize) {
    if (plan.count == 0) return 0;
    return plan.fills() ? room / stackHeight(1, plan.growth, plan.count) : plan.firstAt(cellSize);
}

double askedThickness(const LayerPlan& plan, double room, double cellSize) {
    if (plan.count == 0) return 0;
    return plan.fills() ? room : stackHeight(plan.firstAt(cellSize), plan.growth, plan.count);
}

int wantedCells(const LayerPlan& plan, double room, double cellSize) {
    if (plan.count == 0 || plan.fills()) return std::max(1, plan.count);
    const double first = plan.firstAt(cellSize), top = first * std::pow(plan.growth, plan.count - 1);
    const double left = room - stackHeight(first, plan.growth, plan.count);
    if (!(left > leastTransition * top)) return plan.count;
    int over = 1;
    while (over < maxOver && left > stackHeight(mostTransition * top, mostTransition, over)) ++over;
    return plan.count + over;
}

void stackLevels(const LayerPlan& plan, double room, double cellSize, int cells, double* level) {
    if (cells <= 1) return;
    const int n = plan.fills() ? std::max(plan.count, cells) : std::max(plan.count, 1), over = std::max(0, cells - n);
    double growth = plan.growth, first = plan.fills() ? room / stackHeight(1, growth, n) : plan.firstAt(cellSize);
    const double top = first * std::pow(growth, n - 1), asked = stackHeight(first, growth, n);
    if (plan.fills()) {
        // as it is
    } else if (over > 0) {
        if (room < asked + over * leastTransition * top) fit(first, growth, n, room, over * leastTransition);
    } else if (cells == n) {
        const double more = room - asked; // shared out; ever less of it from half a layer to a whole one, where the last cell takes it
        fit(first, growth, n, more < 0 ? room : asked + std::min(more, std::max(0.0, top - more)), 0);
    } else if (room < stackHeight(first, growth, cells)) {
        fit(first, growth, cells, room, 0);
    }
    double z = 0;
    const int layers = std::min(n, cells);
    for (int j = 0; j < layers && j + 1 < cells; ++j, first *= growth) level[j] = z += first;
    if (over < 2) return;
    double height = first / growth; // of the last layer
    const double ratio = ratioOf((room - z) / height, over);
    for (int j = layers; j + 1 < cells; ++j) level[j] = z += height *= ratio;
}

} // namespace i2b
