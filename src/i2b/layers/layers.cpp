#include "i2b/core/parallel.h"
#include "i2b/layers/layer_stack.h"
#include <fmt/format.h>

namespace i2b {
namespace {

// first * (1 + r + ... + r^(n-1))
double stackHeight(double first, double ratio, int n) {
    double sum = 0, h = first;
    for (int i = 0; i < n; ++i, h *= ratio) sum += h;
    return sum;
}

// The growth ratio with which n layers that start at first fill the height; kept between 1/2 and 4.
double solveGrowth(double first, double height, int n) {
    double lo = 0.5, hi = 4;
    if (stackHeight(first, hi, n) <= height) return hi;
    if (stackHeight(first, lo, n) >= height) return lo;
    for (int i = 0; i < 60; ++i) {
        const double mid = 0.5 * (lo + hi);
        (stackHeight(first, mid, n) < height ? lo : hi) = mid;
    }
    return 0.5 * (lo + hi);
}

} // namespace

LayerStack makeLayers(const Front& front, const LayerOptions& options) {
    LayerStack stack;
    stack.requested = options.count;
    stack.count = std::max(1, options.count);
    const int n = stack.count;
    const std::size_t vertices = front.front.size();
    stack.fractions.resize(vertices * static_cast<std::size_t>(n));
    std::vector<double> first(vertices), asked(vertices);
    parallelFor(vertices, [&](std::size_t v) {
        const auto& p = front.mesh.point(FrontMesh::VertexHandle(static_cast<int>(v)));
        const double height = norm(Vec3{p[0], p[1], p[2]} - front.front[v]);
        const bool given = options.first > 0 && n > 1;
        const double ratio = given ? solveGrowth(options.first, height, n) : options.growth;
        const double sum = stackHeight(1, ratio, n);
        double below = 0; // from the wall upwards
        for (int k = n - 1; k >= 0; --k) {
            stack.fractions[v * static_cast<std::size_t>(n) + static_cast<std::size_t>(k)] = static_cast<float>(1 - below);
            below += std::pow(ratio, n - 1 - k) / sum;
        }
        first[v] = height / sum;
        asked[v] = options.first > 0 ? std::min(1.0, height / std::max(1e-300, stackHeight(options.first, options.growth, n))) : 1;
    });
    const auto add = [](double a, double b) { return a + b; };
    const auto mean = [&](const std::vector<double>& values) {
        const double sum = orderedReduce(
            values.size(), 0.0,
            [&](std::size_t b, std::size_t e) {
                double s = 0;
                for (std::size_t i = b; i < e; ++i) s += values[i];
                return s;
            },
            add);
        return values.empty() ? 0 : sum / static_cast<double>(values.size());
    };
    stack.meanFirstHeight = mean(first);
    stack.thicknessFraction = mean(asked);
    stack.meanCount = n;
    stack.facesCovered = 1;
    return stack;
}

std::string LayerStack::validate() const {
    for (std::size_t i = 0; i < fractions.size(); ++i) {
        const bool last = (i + 1) % static_cast<std::size_t>(count) == 0;
        const float below = i % static_cast<std::size_t>(count) == 0 ? 0.0f : fractions[i - 1];
        if (!(fractions[i] > below) || (last && fractions[i] != 1.0f)) return fmt::format("fractions of vertex {} do not rise to 1", i / static_cast<std::size_t>(count));
    }
    return "";
}

} // namespace i2b
