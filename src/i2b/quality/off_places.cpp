#include "i2b/quality/off_places.h"
#include "i2b/core/parallel.h"
#include "i2b/paint/union_find.h"
#include <algorithm>

namespace i2b {
namespace {

bool isOff(OffCause cause) { return cause != OffCause::none && cause != OffCause::tilted; }

// Joins nodes of one kind that share an edge of a wall face. Gives the lowest node of each one's place.
std::vector<std::uint32_t> placeOfNodes(const PolyMesh& mesh, const WallNodes& nodes, const std::vector<OffCause>& causes) {
    std::vector<std::int32_t> marked(mesh.points.size(), -1); // its place in nodes.points
    for (std::size_t i = 0; i < causes.size(); ++i) {
        if (causes[i] != OffCause::none) marked[static_cast<std::size_t>(nodes.points[i])] = static_cast<std::int32_t>(i);
    }
    UnionFind sets(causes.size());
    for (const Patch& patch : mesh.patches) {
        if (patch.type != "wall") continue;
        parallelFor(static_cast<std::size_t>(patch.count), [&](std::size_t k) {
            const auto face = mesh.face(patch.start + static_cast<std::int32_t>(k));
            for (std::size_t j = 0; j < face.size(); ++j) {
                const std::int32_t a = marked[static_cast<std::size_t>(face[j])], b = marked[static_cast<std::size_t>(face[(j + 1) % face.size()])];
                if (a < 0 || b < 0 || isOff(causes[static_cast<std::size_t>(a)]) != isOff(causes[static_cast<std::size_t>(b)])) continue;
                sets.join(static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b));
            }
        });
    }
    std::vector<std::uint32_t> place(causes.size());
    for (std::size_t i = 0; i < causes.size(); ++i) place[i] = sets.find(static_cast<std::uint32_t>(i));
    return place;
}

struct Gathered { // a place as it grows
    OffPlace place;
    std::array<std::int64_t, offCauses> counts{};
    Vec3 sum;
    void add(const Vec3& p, double distance, OffCause cause) {
        ++place.nodes;
        ++counts[static_cast<std::size_t>(cause)];
        sum += p;
        if (place.box.empty() || distance > place.farthestInH) place.farthestInH = distance, place.farthest = p;
        place.box.add(p);
    }
    OffPlace finished(const SurfaceIndex& index) const {
        OffPlace done = place;
        // Of nodes in one plane the mean may be rounded out of it.
        done.centre = cwiseMax(place.box.lo, cwiseMin(place.box.hi, sum / static_cast<double>(place.nodes)));
        done.cause = static_cast<OffCause>(std::max_element(counts.begin(), counts.end()) - counts.begin());
        const ClosestPoint c = index.closest(place.farthest);
        if (c) done.part = index.surface().parts[index.surface().partOf[c.triangle]].name;
        return done;
    }
};

OffPlaces firstPlaces(std::vector<Gathered>& all, const SurfaceIndex& index, std::size_t most) {
    std::stable_sort(all.begin(), all.end(), [](const Gathered& a, const Gathered& b) {
        return a.place.nodes != b.place.nodes ? a.place.nodes > b.place.nodes : a.place.farthestInH > b.place.farthestInH;
    });
    OffPlaces places;
    places.total = static_cast<std::int64_t>(all.size());
    for (std::size_t i = 0; i < std::min(most, all.size()); ++i) places.first.push_back(all[i].finished(index));
    return places;
}

} // namespace

std::vector<OffCause> settleCauses(const WallNodes& nodes, const std::vector<OffCause>& fit, const std::vector<std::uint8_t>& retreated) {
    std::vector<OffCause> causes(nodes.points.size(), OffCause::none);
    for (std::size_t i = 0; i < causes.size(); ++i) {
        if (nodes.distanceInH[i] > onGeometry) {
            const bool back = i < retreated.size() && retreated[i] != 0;
            const OffCause found = i < fit.size() ? fit[i] : OffCause::none;
            causes[i] = found != OffCause::none ? found : back ? OffCause::retreated : OffCause::unfinished;
        } else if (nodes.tilted[i]) {
            causes[i] = OffCause::tilted;
        }
    }
    return causes;
}

OffGeometry listOffPlaces(const PolyMesh& mesh, const WallNodes& nodes, const std::vector<OffCause>& causes, const SurfaceIndex& index,
                          std::size_t most) {
    OffGeometry off;
    const std::vector<std::uint32_t> placeOf = placeOfNodes(mesh, nodes, causes);
    std::vector<std::int32_t> number(causes.size(), -1); // of the place, at its lowest node
    std::vector<Gathered> places, tilted;
    for (std::size_t i = 0; i < causes.size(); ++i) {
        if (causes[i] == OffCause::none) continue;
        ++(isOff(causes[i]) ? off.nodes : off.tilted);
        ++off.counts[static_cast<std::size_t>(causes[i])];
        std::vector<Gathered>& kind = isOff(causes[i]) ? places : tilted;
        std::int32_t& p = number[placeOf[i]];
        if (p < 0) p = static_cast<std::int32_t>(kind.size()), kind.emplace_back();
        kind[static_cast<std::size_t>(p)].add(mesh.points[static_cast<std::size_t>(nodes.points[i])], nodes.distanceInH[i], causes[i]);
    }
    if (!causes.empty()) off.fraction = static_cast<double>(off.nodes) / static_cast<double>(causes.size());
    off.places = firstPlaces(places, index, most);
    off.tiltedPlaces = firstPlaces(tilted, index, most);
    return off;
}

} // namespace i2b
