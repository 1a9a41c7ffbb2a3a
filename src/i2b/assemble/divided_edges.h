// Core edges along the front into which the fit has put a vertex: every polygon along one has that vertex too.
#pragma once
#include "i2b/front/front.h"
#include <algorithm>

namespace i2b {

class DividedEdges {
  public:
    explicit DividedEdges(const Front& front) {
        if (front.inserted.empty()) return;
        isEnd_.assign(static_cast<std::size_t>(front.corePoints), false);
        for (std::size_t i = 0; i < front.inserted.size(); ++i) {
            const auto [v, w] = front.inserted[i].ends;
            const auto [a, b] = std::minmax(front.corePoint[std::size_t(v)], front.corePoint[std::size_t(w)]);
            edges_.push_back({a, b, front.corePoint[front.firstInserted() + i]});
            isEnd_[std::size_t(a)] = isEnd_[std::size_t(b)] = true;
        }
        std::sort(edges_.begin(), edges_.end());
    }

    // polygon: n core points, n up to half the room. Gives how many there are now.
    std::size_t addTo(std::array<std::int32_t, 16>& polygon, std::size_t n) const {
        if (edges_.empty()) return n;
        const std::array<std::int32_t, 16> old = polygon;
        std::size_t count = 0;
        for (std::size_t i = 0; i < n; ++i) {
            polygon[count++] = old[i];
            const auto [a, b] = std::minmax(old[i], old[(i + 1) % n]);
            if (!isEnd_[std::size_t(a)] || !isEnd_[std::size_t(b)]) continue;
            const auto e = std::lower_bound(edges_.begin(), edges_.end(), Edge{a, b, 0});
            if (e != edges_.end() && e->a == a && e->b == b) polygon[count++] = e->point;
        }
        return count;
    }

  private:
    struct Edge {
        std::int32_t a, b, point;
        friend auto operator<=>(const Edge&, const Edge&) = default;
    };
    std::vector<Edge> edges_; // a < b: its ends; sorted
    std::vector<bool> isEnd_; // per core point
};

} // namespace i2b
