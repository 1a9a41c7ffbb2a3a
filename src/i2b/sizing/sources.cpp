#include "i2b/sizing/sources.h"
#include "i2b/geometry/part_names.h"
#include <algorithm>
#include <fmt/format.h>

namespace i2b {
namespace {

constexpr double mostStretched = 16; // of the largest and the smallest size along the axes of one wish

std::string text(const Vec3& s) {
    return s == sameSize(s.x) ? fmt::format("{:g} m", s.x) : fmt::format("({:g} {:g} {:g}) m", s.x, s.y, s.z);
}
std::string place(const Vec3& p) { return fmt::format("({:g} {:g} {:g})", p.x, p.y, p.z); }

class Sources {
  public:
    Sources(SizeField& field, const Surface& surface, const SizeOptions& size, const SurfaceIndex* index)
        : field_(field), surface_(surface), index_(index), min_(std::min(size.min, field.maxSize)) {}

    void addPart(const PartSize& rule) {
        const std::vector<std::size_t> parts = partsNamed(rule.part);
        const LevelTriple level = levelOf(rule.size, fmt::format("part '{}'", rule.part));
        for (std::size_t p : parts) field_.partLevel[p] = level;
    }
    void addBox(const BoxSize& rule) {
        const std::string name = fmt::format("the box {} to {}", place(rule.box.lo), place(rule.box.hi));
        field_.boxes.push_back({rule.box, levelOf(rule.size, name)});
        expectInside(rule.box, name);
    }
    void add(const SphereSize& rule) {
        add(Capsule{rule.centre, rule.centre, rule.radius}, rule.size, fmt::format("the sphere at {}", place(rule.centre)));
    }
    void add(const CylinderSize& rule) {
        add(Cylinder{rule.from, rule.to, rule.radius}, rule.size,
            fmt::format("the cylinder {} to {}", place(rule.from), place(rule.to)));
    }
    void add(const PointSize& rule) {
        add(Capsule{rule.place, rule.place, 0}, rule.size, fmt::format("the point {}", place(rule.place)));
    }
    void add(const SegmentSize& rule) {
        add(Capsule{rule.from, rule.to, 0}, rule.size, fmt::format("the segment {} to {}", place(rule.from), place(rule.to)));
    }
    void add(const LineSize& rule) {
        const std::string name = fmt::format("the line through {}", place(rule.through));
        Capsule inside;
        if (clip(rule, inside)) {
            add(inside, rule.size, name);
        } else {
            note("{} misses the domain", name);
        }
    }
    void add(const BandSize& rule) {
        const std::vector<std::size_t> parts = partsNamed(rule.part);
        if (parts.empty()) return;
        add(PartsBand{indexOf(parts), rule.distance}, rule.size,
            fmt::format("the band around '{}'", rule.part));
    }

  private:
    template <class... Args>
    void note(fmt::format_string<Args...> format, Args&&... args) {
        field_.notes.push_back(fmt::format(format, std::forward<Args>(args)...));
    }
    void expectInside(const Box& box, const std::string& name) {
        if (!box.overlaps(field_.lattice.domain())) note("{} lies outside the domain", name);
    }
    void add(Shape shape, const Vec3& size, const std::string& name) {
        expectInside(boundsOf(shape), name);
        field_.shapes.push_back({std::move(shape), levelOf(size, name)});
    }
    LevelTriple levelOf(const Vec3& asked, const std::string& name);
    std::vector<std::size_t> partsNamed(const std::string& name);
    std::shared_ptr<const PartsIndex> indexOf(const std::vector<std::size_t>& parts) const;
    bool clip(const LineSize& rule, Capsule& inside) const;

    SizeField& field_;
    const Surface& surface_;
    const SurfaceIndex* index_; // of the surface, or null
    double min_; // m
};

LevelTriple Sources::levelOf(const Vec3& asked, const std::string& name) {
    Vec3 given = asked;
    for (int a = 0; a < 3; ++a) given[a] = std::clamp(given[a], min_, field_.maxSize);
    if (given != asked) {
        note("the size {} of {} is clamped to {}: cells are {:g} m at least and {:g} m at most", text(asked), name,
             text(given), min_, field_.maxSize);
    }
    const double least = std::min(given.x, std::min(given.y, given.z));
    Vec3 cubic = given;
    for (int a = 0; a < 3; ++a) cubic[a] = std::min(given[a], mostStretched * least);
    if (cubic != given) {
        note("the size {} of {} is clamped to {}: cells are at most {:g} times as long as high", text(given), name,
             text(cubic), mostStretched);
    }
    return levelFor(field_.lattice, cubic);
}

std::vector<std::size_t> Sources::partsNamed(const std::string& name) {
    std::vector<std::size_t> found;
    const NamePattern pattern(name);
    for (std::size_t p = 0; p < surface_.parts.size(); ++p) {
        if (pattern.matches(surface_.parts[p].name)) found.push_back(p);
    }
    if (found.empty()) note("no part is named '{}'", name);
    return found;
}

std::shared_ptr<const PartsIndex> Sources::indexOf(const std::vector<std::size_t>& parts) const {
    std::vector<bool> chosen(surface_.parts.size());
    for (std::size_t p : parts) chosen[p] = true;
    if (index_) {
        const auto triangles = static_cast<std::size_t>(std::count_if(surface_.partOf.begin(), surface_.partOf.end(), [&](auto p) { return chosen[static_cast<std::size_t>(p)]; }));
        if (2 * triangles >= surface_.triangles.size()) return std::make_shared<PartsIndex>(*index_, chosen);
    }
    Surface some;
    some.points = surface_.points;
    some.parts = surface_.parts;
    for (std::size_t t = 0; t < surface_.triangles.size(); ++t) {
        if (!chosen[static_cast<std::size_t>(surface_.partOf[t])]) continue;
        some.triangles.push_back(surface_.triangles[t]);
        some.partOf.push_back(surface_.partOf[t]);
    }
    return std::make_shared<PartsIndex>(std::move(some));
}

// The part of a line inside the domain, a trifle longer.
bool Sources::clip(const LineSize& rule, Capsule& inside) const {
    const Box box = field_.lattice.domain();
    const Vec3 d = normalized(rule.direction);
    const double reach = norm(box.extent());
    double first = -std::numeric_limits<double>::infinity(), last = -first;
    for (int a = 0; a < 3; ++a) {
        if (d[a] == 0) {
            if (rule.through[a] < box.lo[a] || rule.through[a] > box.hi[a]) return false;
            continue;
        }
        const double s = (box.lo[a] - rule.through[a]) / d[a], t = (box.hi[a] - rule.through[a]) / d[a];
        first = std::max(first, std::min(s, t)), last = std::min(last, std::max(s, t));
    }
    if (!(first <= last + 1e-12 * reach)) return false;
    inside = {rule.through + d * (first - 1e-9 * reach), rule.through + d * (last + 1e-9 * reach), 0};
    return true;
}

} // namespace

void addSources(SizeField& field, const Surface& surface, const SizeOptions& size, const SurfaceIndex* index) {
    Sources sources(field, surface, size, index);
    for (const PartSize& rule : size.parts) sources.addPart(rule);
    for (const BoxSize& rule : size.boxes) sources.addBox(rule);
    for (const SphereSize& rule : size.spheres) sources.add(rule);
    for (const CylinderSize& rule : size.cylinders) sources.add(rule);
    for (const BandSize& rule : size.bands) sources.add(rule);
    for (const PointSize& rule : size.points) sources.add(rule);
    for (const SegmentSize& rule : size.segments) sources.add(rule);
    for (const LineSize& rule : size.lines) sources.add(rule);
}

} // namespace i2b
