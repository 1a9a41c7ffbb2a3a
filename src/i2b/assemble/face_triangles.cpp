#include "i2b/assemble/face_triangles.h"
#include <algorithm>
#include <limits>

namespace i2b {
namespace {

using Index = std::size_t;

class Widest {
  public:
    Widest(std::span<const Vec3> points, std::span<const std::int32_t> face) : count_(face.size()), least_(count_ * count_), middle_(count_ * count_) {
        places_.reserve(count_);
        for (const std::int32_t p : face) places_.push_back(points[Index(p)] - points[Index(face.front())]);
        Vec3 area;
        for (Index i = 1; i + 1 < count_; ++i) area += cross(places_[i], places_[i + 1]);
        normal_ = normalized(area);
        for (Index length = 1; length < count_; ++length)
            for (Index i = 0; i + length < count_; ++i) join(i, i + length);
    }
    std::vector<FaceTriangle> triangles() const {
        std::vector<FaceTriangle> all;
        add(0, count_ - 1, all);
        return all;
    }

  private:
    // The chain of vertices from i to j, closed by the line between them.
    void join(Index i, Index j) {
        double& best = least_[i * count_ + j];
        best = std::numeric_limits<double>::max();
        if (j == i + 1) return;
        best = std::numeric_limits<double>::lowest();
        for (Index k = i + 1; k < j; ++k) {
            const double width = std::min({widthOf(i, k, j), least_[i * count_ + k], least_[k * count_ + j]});
            if (k > i + 1 && !(width > best)) continue;
            best = width;
            middle_[i * count_ + j] = static_cast<std::uint32_t>(k);
        }
    }
    double widthOf(Index i, Index k, Index j) const {
        const Vec3 a = places_[k] - places_[i], b = places_[j] - places_[i];
        const double side2 = std::max({norm2(a), norm2(b), norm2(b - a)});
        return side2 > 0 ? dot(cross(a, b), normal_) / side2 : 0;
    }
    void add(Index i, Index j, std::vector<FaceTriangle>& to) const {
        if (j == i + 1) return;
        const Index k = middle_[i * count_ + j];
        add(i, k, to);
        to.push_back({static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(k), static_cast<std::uint32_t>(j)});
        add(k, j, to);
    }

    Index count_;
    std::vector<double> least_;          // per first and last of a chain, the width of the thinnest triangle
    std::vector<std::uint32_t> middle_;  // and the third vertex of the one at the closing line
    std::vector<Vec3> places_;           // from the first vertex, m
    Vec3 normal_;
};

} // namespace

std::vector<FaceTriangle> trianglesOf(std::span<const Vec3> points, std::span<const std::int32_t> face, std::uint32_t from) {
    const auto corners = static_cast<std::uint32_t>(face.size());
    if (from == widest) return Widest(points, face).triangles();
    std::vector<FaceTriangle> fan;
    for (std::uint32_t k = 1; k + 1 < corners; ++k) fan.push_back({from, (from + k) % corners, (from + k + 1) % corners});
    return fan;
}

} // namespace i2b
