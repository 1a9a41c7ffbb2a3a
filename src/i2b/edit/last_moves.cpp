#include "i2b/edit/last_moves.h"
#include "i2b/core/sort_unique.h"
#include "i2b/edit/shape_zip.h"
#include "i2b/quality/mesh_geometry.h"
#include <algorithm>
#include <cmath>
#include <map>

namespace i2b {
namespace {

using Index = std::size_t;
constexpr Index most = 50; // faces: where there are more it is not single points that are wrong

// The cells around a face's cells, and the points of these, each by itself, that no boundary holds.
Zip placeAround(const PolyMesh& mesh, const Rows& cellFaces, const ZipStar& star, std::int32_t face) {
    Zip place;
    std::vector<std::int32_t> points, held;
    std::vector<std::int32_t> sides{mesh.owner[Index(face)]};
    if (face < mesh.internalFaces()) sides.push_back(mesh.neighbour[Index(face)]);
    for (const std::int32_t cell : sides) {
        std::vector<std::int32_t> own;
        for (const std::int32_t f : cellFaces[cell]) own.insert(own.end(), mesh.face(f).begin(), mesh.face(f).end());
        sortUnique(own);
        for (const std::int32_t p : own) {
            const std::vector<std::int32_t> cells = star.cellsAt(p, -1, cell);
            place.star.insert(place.star.end(), cells.begin(), cells.end());
        }
        points.insert(points.end(), own.begin(), own.end());
    }
    sortUnique(points), sortUnique(place.star);
    for (const std::int32_t c : place.star)
        for (const std::int32_t f : cellFaces[c])
            if (f >= mesh.internalFaces()) held.insert(held.end(), mesh.face(f).begin(), mesh.face(f).end());
    sortUnique(held);
    for (const std::int32_t p : points)
        if (!std::ranges::binary_search(held, p)) place.columns.push_back({{p}, {1}});
    place.h = std::sqrt(norm(measureFace(mesh, face).area));
    return place;
}

} // namespace

std::int64_t moveLastPoints(PolyMesh& mesh, const Rows& cellFaces, const std::vector<std::int32_t>& faces, const DictionaryLimits& limits) {
    if (faces.empty() || faces.size() > most) return 0;
    ZipStar star(mesh, cellFaces);
    std::map<std::int32_t, Vec3> places; // m, of points that stay moved
    std::int64_t helped = 0;
    for (const std::int32_t face : faces) {
        const Zip place = placeAround(mesh, cellFaces, star, face);
        const Verdict before = star.now(place, limits);
        std::map<std::int32_t, Vec3> all = places;
        for (const auto& [point, to] : shapeZip(star, place, limits)) all[point] = to;
        star.use({}, all);
        const Verdict now = star.now(place, limits);
        if (isBetter(now, before)) places = std::move(all), ++helped;
        else star.use({}, places);
    }
    return helped;
}

} // namespace i2b
