#pragma once
#include "i2b/fit/wall_views.h"
#include "pipeline/stages_run.h"
#include <map>

namespace i2b::test {

// A fit without features, and the positions of the band's nodes after it: nothing is snapped to anything.
struct Unsnapped : ToFront {
    explicit Unsnapped(const Surface& soup) : ToFront(soup, stagesOptions()), band(buildBand(lattice, front, 2)), views(band, *painted.index), snaps(band.walls) {
        FitOptions options;
        options.features = false;
        fitFront(front, lattice, *painted.index, graph, options, Context());
        x = band.start;
        std::map<std::int32_t, Vec3> moved;
        for (std::size_t i = 0; i < front.movedPoints.size(); ++i) moved[front.movedPoints[i]] = front.movedTo[i];
        for (std::size_t n = band.walls; n < band.nodes(); ++n)
            if (const auto at = moved.find(band.corePoint[n - band.walls]); at != moved.end()) x[n] = at->second;
        for (std::size_t v = 0; v < band.walls; ++v) x[v] = wallPoint(front, v), x[static_cast<std::size_t>(band.frontNode[v])] = front.front[v];
    }
    Band band;
    WallViews views;
    Positions x;
    std::vector<Snap> snaps;
};

} // namespace i2b::test
