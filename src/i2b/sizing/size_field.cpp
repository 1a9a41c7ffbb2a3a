#include "i2b/sizing/size_field.h"
#include "i2b/core/error.h"
#include "i2b/sizing/sources.h"
#include <fmt/format.h>

namespace i2b {
namespace {

constexpr double slack = 1e-9;   // relative: a size that divides the box exactly is taken as such
constexpr int mostBits = 28;     // of a cell's coordinate: places in quarters of its edges must fit into 32 bits
constexpr int highestLevel = 20;

// The largest surface * 2^k that does not exceed limit.
double multipleBelow(double surface, double limit) {
    double size = surface;
    while (size * 2 <= limit * (1 + slack)) size *= 2;
    return size;
}

// 10 body lengths around a body in external flow; a margin of two cells around an internal domain.
Box defaultBox(const Box& body, double maxSize, Flow flow) {
    const Vec3 e = body.extent();
    const double length = std::max(e.x, std::max(e.y, e.z));
    const double margin = flow == Flow::internal ? 2 * maxSize : 10 * length;
    Box box;
    for (int i = 0; i < 3; ++i) {
        const double n = std::ceil((e[i] + 2 * margin) / maxSize - slack);
        box.lo[i] = body.centre()[i] - 0.5 * n * maxSize;
        box.hi[i] = body.centre()[i] + 0.5 * n * maxSize;
    }
    return box;
}

Flow resolvedFlow(const DomainOptions& domain) {
    if (domain.flow != Flow::automatic) return domain.flow;
    return domain.seeds.empty() ? Flow::external : Flow::internal;
}

int axisLevel(double base, double size) {
    int level = 0;
    while (std::ldexp(base, -level) > size * (1 + slack)) {
        if (++level <= highestLevel) continue;
        throw Error(ErrorKind::input, fmt::format("cells of {:g} m are too small for a largest cell of {:g} m", size, base),
                    fmt::format("more than {} levels", highestLevel), "give a larger --size or a smaller --max-size");
    }
    return level;
}

Box meshedBounds(const Surface& surface) {
    const Box body = surface.bounds();
    if (body.empty()) {
        throw Error(ErrorKind::input, "the geometry has no triangles", "", "give a file that holds a surface");
    }
    return body;
}

Lattice makeLattice(const Box& box, double maxSize) {
    Lattice lattice;
    lattice.origin = box.lo;
    for (std::size_t i = 0; i < 3; ++i) {
        const int axis = static_cast<int>(i);
        const double n = std::max(1.0, std::ceil(box.extent()[axis] / maxSize - 1e-6));
        if (n > 1e6) {
            throw Error(ErrorKind::input, fmt::format("the largest cell, {:g} m, is too small for the domain", maxSize),
                        fmt::format("axis {}", "xyz"[i]), "give a larger --max-size");
        }
        lattice.count[i] = static_cast<std::int32_t>(n);
        lattice.base[axis] = box.extent()[axis] / n;
    }
    return lattice;
}

double largestCell(const Box& body, const SizeOptions& size, const DomainOptions& domain) {
    if (size.max > 0) return size.max;
    const Vec3 e = (domain.box ? *domain.box : body).extent(), b = body.extent();
    const double bodyLength = std::max(b.x, std::max(b.y, b.z));
    const double limit = resolvedFlow(domain) == Flow::internal ? bodyLength / 8
                                                                : std::min(bodyLength, std::max(e.x, std::max(e.y, e.z)));
    return multipleBelow(size.surface, std::max(size.surface, limit));
}

Box domainBox(const Box& body, double maxSize, const DomainOptions& domain) {
    const Box box = domain.box ? *domain.box : defaultBox(body, maxSize, resolvedFlow(domain));
    if (box.overlaps(body)) return box;
    throw Error(ErrorKind::input, "the domain box holds none of the geometry",
                fmt::format("box ({:g} {:g} {:g}) to ({:g} {:g} {:g}), geometry ({:g} {:g} {:g}) to ({:g} {:g} {:g})",
                            box.lo.x, box.lo.y, box.lo.z, box.hi.x, box.hi.y, box.hi.z, body.lo.x, body.lo.y, body.lo.z,
                            body.hi.x, body.hi.y, body.hi.z),
                "check --box and --scale");
}

} // namespace

LevelTriple levelFor(const Lattice& lattice, const Vec3& size) {
    const Vec3& base = lattice.base;
    if (size == sameSize(size.x)) return allAxes(axisLevel(std::max(base.x, std::max(base.y, base.z)), size.x));
    LevelTriple level;
    for (std::size_t i = 0; i < 3; ++i) {
        level[i] = static_cast<std::uint8_t>(axisLevel(base[static_cast<int>(i)], size[static_cast<int>(i)]));
    }
    return level;
}

SizeField makeSizeField(const Surface& surface, const SizeOptions& size, const DomainOptions& domain, const SurfaceIndex* index) {
    const Box body = meshedBounds(surface);
    SizeField field;
    field.surfaceSize = size.surface;
    field.maxSize = largestCell(body, size, domain);
    field.lattice = makeLattice(domainBox(body, field.maxSize, domain), field.maxSize);
    field.bufferCells = std::max(1, size.bufferCells);
    field.partLevel.assign(surface.parts.size(), levelFor(field.lattice, sameSize(size.surface)));
    addSources(field, surface, size, index);
    settleLevels(field);
    return field;
}

void settleLevels(SizeField& field) {
    Lattice& lattice = field.lattice;
    const auto raise = [&](const LevelTriple& level) { lattice.maxLevel = std::max(lattice.maxLevel, level.finest()); };
    for (const LevelTriple& level : field.partLevel) raise(level);
    for (const LevelTriple& level : field.triangleLevel) raise(level);
    for (const LevelBox& rule : field.boxes) raise(rule.level);
    for (const LevelShape& rule : field.shapes) raise(rule.level);
    for (const LevelCells& gap : field.gaps) raise(gap.level);
    field.minSize = lattice.h(lattice.maxLevel);
    for (std::int32_t n : lattice.count) {
        if (std::ldexp(n, lattice.maxLevel) > double(1 << mostBits)) {
            throw Error(ErrorKind::input, fmt::format("cells of {:g} m are too small for the domain", field.minSize),
                        fmt::format("more than 2^{} along an axis", mostBits), "give a larger --size or a smaller --box");
        }
    }
}

std::vector<LevelTriple> SizeField::targets() const {
    std::vector<LevelTriple> all = triangleLevel.empty() ? partLevel : triangleLevel;
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
}

std::string SizeField::validate() const {
    for (int i = 0; i < 3; ++i) {
        if (!(lattice.base[i] > 0)) return "base cell without extent";
        if (lattice.count[static_cast<std::size_t>(i)] < 1) return "no base cells";
    }
    for (const LevelTriple& level : partLevel) {
        if (level.finest() > lattice.maxLevel) return "part level out of range";
    }
    return "";
}

} // namespace i2b
