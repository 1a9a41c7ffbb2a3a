#include "i2b/geometry/surface.h"
#include "i2b/core/checksum.h"
#include "i2b/core/parallel.h"
#include <fmt/format.h>
#include <unordered_set>

namespace i2b {
namespace {

template <class Accept>
Box boundsWhere(const Surface& surface, const Accept& accept) {
    return orderedReduce(
        surface.triangles.size(), Box{},
        [&](std::size_t begin, std::size_t end) {
            Box box;
            for (std::size_t t = begin; t != end; ++t)
                if (accept(t))
                    for (const std::uint32_t v : surface.triangles[t]) box.add(surface.points[v]);
            return box;
        },
        [](Box a, const Box& b) { return a.add(b), a; });
}

// The first i in [0, n) with bad(i), or n.
template <class Bad>
std::size_t firstWhere(std::size_t n, const Bad& bad) {
    return orderedReduce(
        n, n,
        [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i != end; ++i)
                if (bad(i)) return i;
            return n;
        },
        [](std::size_t a, std::size_t b) { return std::min(a, b); });
}

std::string validateParts(const Surface& s) {
    std::unordered_set<std::string> names;
    for (std::size_t p = 0; p < s.parts.size(); ++p) {
        if (s.parts[p].name.empty()) return fmt::format("part {} has no name", p);
        if (!names.insert(s.parts[p].name).second)
            return fmt::format("two parts are called {}", s.parts[p].name);
    }
    std::vector<std::uint64_t> counts(s.parts.size());
    for (const std::int32_t p : s.partOf) ++counts[static_cast<std::size_t>(p)];
    for (std::size_t p = 0; p < s.parts.size(); ++p)
        if (counts[p] != s.parts[p].triangles)
            return fmt::format("part {} says {} triangles and has {}", s.parts[p].name, s.parts[p].triangles,
                               counts[p]);
    return {};
}

std::string validateFree(const Surface& s) {
    const std::size_t points = s.points.size();
    for (std::size_t i = 0; i < s.segments.size(); ++i) {
        const FreeSegment& f = s.segments[i];
        if (f.a >= points || f.b >= points) return fmt::format("segment {} names a point out of range", i);
        if (f.part < 0 || static_cast<std::size_t>(f.part) >= s.parts.size())
            return fmt::format("segment {} names part {}, out of range", i, f.part);
    }
    for (std::size_t i = 0; i < s.freePoints.size(); ++i)
        if (s.freePoints[i] >= points) return fmt::format("free point {} names a point out of range", i);
    return {};
}

} // namespace

Box Surface::bounds() const {
    return boundsWhere(*this, [](std::size_t) { return true; });
}

Box Surface::bounds(std::int32_t part) const {
    return boundsWhere(*this, [&](std::size_t t) { return partOf[t] == part; });
}

std::string Surface::validate() const {
    if (partOf.size() != triangles.size())
        return fmt::format("{} triangles but {} part ids", triangles.size(), partOf.size());
    if (points.size() > ~std::uint32_t{0})
        return fmt::format("{} points are more than 32 bits count", points.size());
    const std::size_t badPoint =
        firstWhere(points.size(), [&](std::size_t i) { return !isFinite(points[i]); });
    if (badPoint != points.size()) return fmt::format("point {} is not finite", badPoint);
    const std::size_t badTriangle = firstWhere(triangles.size(), [&](std::size_t t) {
        const auto& v = triangles[t];
        return v[0] >= points.size() || v[1] >= points.size() || v[2] >= points.size();
    });
    if (badTriangle != triangles.size())
        return fmt::format("triangle {} names a point out of range", badTriangle);
    const std::size_t badPart = firstWhere(partOf.size(), [&](std::size_t t) {
        return partOf[t] < 0 || static_cast<std::size_t>(partOf[t]) >= parts.size();
    });
    if (badPart != partOf.size())
        return fmt::format("triangle {} names part {}, out of range", badPart, partOf[badPart]);
    if (std::string fault = validateParts(*this); !fault.empty()) return fault;
    return validateFree(*this);
}

// Part::file is left out: the same geometry read from elsewhere is the same geometry.
std::uint64_t Surface::checksum() const {
    static_assert(sizeof(FreeSegment) == 12, "padding would make the checksum depend on chance");
    Checksum sum;
    sum.add(std::span<const Vec3>(points));
    sum.add(std::span<const std::array<std::uint32_t, 3>>(triangles));
    sum.add(std::span<const std::int32_t>(partOf));
    for (const Part& part : parts) sum.add(std::string_view(part.name)), sum.add(part.triangles);
    sum.add(std::span<const FreeSegment>(segments));
    sum.add(std::span<const std::uint32_t>(freePoints));
    return sum.value();
}

} // namespace i2b
