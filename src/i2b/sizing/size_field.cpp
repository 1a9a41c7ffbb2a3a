#include "i2b/sizing/size_field.h"
#include "i2b/core/error.h"
#include "i2b/core/parallel.h"
#include <fmt/format.h>
#include <regex>

namespace i2b {
namespace {

constexpr double slack = 1e-9;   // relative: a size that divides the box exactly is taken as such
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

// One size for all axes gives one level: base cells are cubes as nearly as the domain allows.
LevelTriple levelFor(const Vec3& base, const Vec3& size) {
    if (size.x == size.y && size.y == size.z) return allAxes(axisLevel(std::max(base.x, std::max(base.y, base.z)), size.x));
    LevelTriple level;
    for (std::size_t i = 0; i < 3; ++i) {
        level[i] = static_cast<std::uint8_t>(axisLevel(base[static_cast<int>(i)], size[static_cast<int>(i)]));
    }
    return level;
}

Vec3 clamped(const Vec3& size, double lo, double hi) {
    return {std::clamp(size.x, lo, hi), std::clamp(size.y, lo, hi), std::clamp(size.z, lo, hi)};
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

void applyPartSizes(SizeField& field, const Surface& surface, const SizeOptions& size, double smallest) {
    for (const PartSize& rule : size.parts) {
        bool used = false;
        const std::regex pattern(rule.part);
        const Vec3 asked = clamped(rule.size, smallest, field.maxSize);
        if (asked != rule.size) {
            field.notes.push_back(fmt::format("size {:g} m of part '{}' clamped to {:g} m", rule.size.x, rule.part, asked.x));
        }
        for (std::size_t p = 0; p < surface.parts.size(); ++p) {
            if (surface.parts[p].name != rule.part && !std::regex_match(surface.parts[p].name, pattern)) continue;
            field.partLevel[p] = levelFor(field.lattice.base, asked);
            used = true;
        }
        if (!used) field.notes.push_back(fmt::format("no part is named '{}'", rule.part));
    }
}

} // namespace

SizeField makeSizeField(const Surface& surface, const SizeOptions& size, const DomainOptions& domain) {
    const Box body = meshedBounds(surface);
    const Vec3 e = (domain.box ? *domain.box : body).extent();
    const Vec3 b = body.extent();
    const double bodyLength = std::max(b.x, std::max(b.y, b.z));
    const Flow flow = resolvedFlow(domain);
    double maxSize = size.max;
    if (maxSize <= 0) {
        const double limit = flow == Flow::internal ? bodyLength / 8 : std::min(bodyLength, std::max(e.x, std::max(e.y, e.z)));
        maxSize = multipleBelow(size.surface, std::max(size.surface, limit));
    }
    const Box box = domain.box ? *domain.box : defaultBox(body, maxSize, flow);
    if (!box.overlaps(body)) {
        throw Error(ErrorKind::input, "the domain box holds none of the geometry",
                    fmt::format("box ({:g} {:g} {:g}) to ({:g} {:g} {:g}), geometry ({:g} {:g} {:g}) to ({:g} {:g} {:g})",
                                box.lo.x, box.lo.y, box.lo.z, box.hi.x, box.hi.y, box.hi.z, body.lo.x, body.lo.y,
                                body.lo.z, body.hi.x, body.hi.y, body.hi.z),
                    "check --box and --scale");
    }
    SizeField field;
    field.lattice = makeLattice(box, maxSize);
    field.bufferCells = std::max(1, size.bufferCells);
    field.surfaceSize = size.surface;
    field.maxSize = maxSize;
    const double smallest = size.min > 0 ? size.min : 0;
    field.partLevel.assign(surface.parts.size(), levelFor(field.lattice.base, sameSize(size.surface)));
    applyPartSizes(field, surface, size, smallest);
    for (const BoxSize& rule : size.boxes) {
        field.boxes.push_back({rule.box, levelFor(field.lattice.base, clamped(rule.size, smallest, maxSize))});
    }
    for (const LevelTriple& level : field.partLevel) field.lattice.maxLevel = std::max(field.lattice.maxLevel, level.finest());
    for (const LevelBox& rule : field.boxes) field.lattice.maxLevel = std::max(field.lattice.maxLevel, rule.level.finest());
    field.minSize = field.lattice.h(field.lattice.maxLevel);
    for (std::int32_t n : field.lattice.count) {
        if (std::ldexp(n, field.lattice.maxLevel) > double(1 << 30)) {
            throw Error(ErrorKind::input, fmt::format("cells of {:g} m are too small for the domain", field.minSize),
                        "more than 2^30 along an axis", "give a larger --size or a smaller --box");
        }
    }
    return field;
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

double estimateBytes(const Surface& surface, const SizeField& field, int layers, bool gridOnly) {
    // Cells that a triangle cuts: its area over h^2, half as much again for slanted ones, and one for itself; the
    // grid then has about ten cells beside every cut one, over all levels.
    double cut = 0, wall = 0;
    const Box domain = field.lattice.domain();
    const double sum = orderedReduce(
        surface.triangles.size(), 0.0,
        [&](std::size_t begin, std::size_t end) {
            double s = 0;
            for (std::size_t t = begin; t < end; ++t) {
                Box box;
                for (std::uint32_t v : surface.triangles[t]) box.add(surface.points[v]);
                if (!box.overlaps(domain)) continue;
                const Vec3& a = surface.points[surface.triangles[t][0]];
                const double area = 0.5 * norm(cross(surface.points[surface.triangles[t][1]] - a,
                                                     surface.points[surface.triangles[t][2]] - a));
                const double h = field.lattice.h(field.partLevel[static_cast<std::size_t>(surface.partOf[t])]);
                s += area / (h * h);
            }
            return s;
        },
        [](double a, double b) { return a + b; });
    wall = sum;
    cut = 1.5 * sum;
    double cells = 8 * cut + field.lattice.count[0] * double(field.lattice.count[1]) * field.lattice.count[2];
    for (const LevelBox& rule : field.boxes) {
        double n = 1;
        const Vec3 h = field.lattice.cellSize(rule.level);
        for (int i = 0; i < 3; ++i) {
            n *= std::max(0.0, std::min(rule.box.hi[i], domain.hi[i]) - std::max(rule.box.lo[i], domain.lo[i])) / h[i] + 1;
        }
        cells += n;
    }
    const double fixed = 150e6 + 250.0 * static_cast<double>(surface.triangles.size());
    return fixed + (gridOnly ? 3 * cells : 250 * cells + 800 * wall + 150 * wall * layers);
}

} // namespace i2b
