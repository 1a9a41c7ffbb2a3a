#include "i2b/edit/poor_places.h"
#include "i2b/core/parallel.h"
#include "i2b/quality/measures.h"
#include <algorithm>
#include <cmath>
#include <numbers>

namespace i2b {
namespace {

using Index = std::size_t;
constexpr Index fewFlat = 200, oneIn = 1000; // thin cells of a small determinant, or one in so many of all

// The numbers under n for which a test holds, ascending. make() gives each chunk a test(number) of its own.
template <class Make>
std::vector<std::int32_t> numbersWhere(std::size_t n, const Make& make) {
    using Numbers = std::vector<std::int32_t>;
    const auto found = [&](std::size_t begin, std::size_t end) {
        Numbers numbers;
        auto test = make();
        for (std::size_t i = begin; i < end; ++i)
            if (test(i)) numbers.push_back(static_cast<std::int32_t>(i));
        return numbers;
    };
    return orderedReduce(n, Numbers{}, found, [](Numbers all, const Numbers& next) {
        all.insert(all.end(), next.begin(), next.end());
        return all;
    });
}

} // namespace

std::vector<std::int32_t> concaveFaces(const PolyMesh& mesh, double degrees) {
    const double sine = std::sin(degrees * std::numbers::pi / 180), least2 = 0.99 * sine * sine;
    const auto isConcave = [&](Index f) {
        const auto v = mesh.face(static_cast<std::int32_t>(f));
        if (v.size() == 3) return false;
        const auto edge = [&](Index i) { return mesh.points[Index(v[(i + 1) % v.size()])] - mesh.points[Index(v[i % v.size()])]; };
        Vec3 twice, before = edge(v.size() - 1);
        for (Index i = 1; i + 1 < v.size(); ++i) twice += cross(mesh.points[Index(v[i])] - mesh.points[Index(v[0])], edge(i));
        for (Index i = 0; i < v.size(); ++i) {
            const Vec3 next = edge(i), turn = cross(before, next);
            if (!(dot(turn, twice) > 0) && norm2(turn) > least2 * norm2(before) * norm2(next)) return true;
            before = next;
        }
        return false;
    };
    return numbersWhere(Index(mesh.faces()), [&] { return isConcave; });
}

std::optional<std::vector<std::int32_t>> facesOfFlatCells(const PolyMesh& mesh, const Rows& cellFaces, std::int32_t thinFrom, double determinant) {
    const std::vector<std::int32_t> flat = numbersWhere(Index(mesh.cells - thinFrom), [&] {
        return [&, shapes = CellFaceShapes(mesh)](Index i) mutable {
            return cellFullness(shapes.of(cellFaces[thinFrom + static_cast<std::int32_t>(i)])) < determinant;
        };
    });
    if (flat.size() > std::max(fewFlat, Index(mesh.cells - thinFrom) / oneIn)) return {};
    std::vector<std::int32_t> faces;
    for (const std::int32_t i : flat) faces.insert(faces.end(), cellFaces[thinFrom + i].begin(), cellFaces[thinFrom + i].end());
    std::sort(faces.begin(), faces.end());
    faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
    return faces;
}

} // namespace i2b
