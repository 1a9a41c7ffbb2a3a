#include "i2b/geometry/inspect.h"
#include <algorithm>
#include <fmt/format.h>
#include <iterator>

namespace i2b {
namespace {

std::string place(const Vec3& p) { return fmt::format("({:.6g} {:.6g} {:.6g})", p.x, p.y, p.z); }

std::string boxText(const Box& box) {
    return box.empty() ? std::string("none") : place(box.lo) + " to " + place(box.hi);
}

// A length in the unit a reader needs no zeros for.
std::string length(double metres) {
    if (metres == 0) return "0";
    if (metres >= 1) return fmt::format("{:.4g} m", metres);
    if (metres >= 1e-3) return fmt::format("{:.4g} mm", metres * 1e3);
    return fmt::format("{:.4g} um", metres * 1e6);
}

} // namespace

std::string format(const InspectReport& r) {
    std::string text;
    const auto line = [&]<class... A>(fmt::format_string<A...> pattern, A&&... values) {
        fmt::format_to(std::back_inserter(text), pattern, std::forward<A>(values)...);
        text += '\n';
    };
    std::size_t width = 4;
    for (const PartFigures& part : r.parts) width = std::max(width, part.name.size());
    line("{:<{}}  {:>10}  {:>11}  box, m", "part", width, "triangles", "area, m2");
    for (const PartFigures& part : r.parts)
        line("{:<{}}  {:>10}  {:>11.5g}  {}", part.name, width, part.triangles, part.area, boxText(part.box));
    text += '\n';
    line("parts                {}", r.parts.size());
    line("triangles            {}", r.triangles);
    line("points               {}", r.points);
    if (r.segments + r.freePoints > 0) line("lines, free points   {}, {}", r.segments, r.freePoints);
    line("bounds, m            {}", boxText(r.bounds));
    if (!r.bounds.empty()) line("extent, m            {}", place(r.bounds.extent()));
    line("area, m2             {:.6g}", r.area);
    line("edge length          smallest {}, median {}, largest {}", length(r.smallestEdge),
         length(r.medianEdge), length(r.largestEdge));
    line("after welding        {} points within {}", r.weldedPoints, length(r.weldTolerance));
    line("degenerate triangles {}", r.degenerateTriangles);
    line("duplicate triangles  {}", r.duplicateTriangles);
    line("open edges           {}, {} long", r.openEdges, length(r.openEdgeLength));
    line("non-manifold edges   {}, {} long", r.nonManifoldEdges, length(r.nonManifoldEdgeLength));
    line("sharp edges          {}, {} long, {} corners", r.sharpEdges, length(r.sharpEdgeLength), r.corners);
    if (r.namedEdges > 0) line("named edges          {}, {} long", r.namedEdges, length(r.namedEdgeLength));
    line("suggested size       {:g} m (--size)", r.suggestedSize);
    return text;
}

} // namespace i2b
