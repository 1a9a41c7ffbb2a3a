#include "i2b/write/vtu_cells.h"
#include <algorithm>

namespace i2b {
namespace {

using Span = std::span<const std::int32_t>;

bool holds(Span face, std::int32_t v) { return std::find(face.begin(), face.end(), v) != face.end(); }

// The points above the base polygon: each edge of it is in one other face, which leads up from both its ends. False where
// these disagree, or a point above is one of the base. No face has more than four vertices.
bool raise(const PolyMesh& mesh, Span cellFaces, std::int32_t base, std::span<const std::int32_t> ring,
           std::span<std::int32_t> above) {
    std::fill(above.begin(), above.end(), -1);
    const std::size_t n = ring.size(), none = n;
    const auto spotOf = [&](std::int32_t v) {
        std::size_t i = 0;
        while (i < n && ring[i] != v) ++i;
        return i;
    };
    const auto after = [](std::size_t i, std::size_t of) { return i + 1 == of ? 0 : i + 1; };
    std::array<int, 4> facesOf{}; // per edge of the base
    for (const std::int32_t f : cellFaces) {
        if (f == base) continue;
        const Span face = mesh.face(f);
        const std::size_t m = face.size();
        std::array<std::size_t, 4> spot;
        for (std::size_t k = 0; k < m; ++k) spot[k] = spotOf(face[k]);
        for (std::size_t k = 0; k < m; ++k) {
            const std::size_t next = after(k, m), i = spot[k], j = spot[next];
            if (i == none || j == none || (after(i, n) != j && after(j, n) != i)) continue;
            ++facesOf[after(i, n) == j ? i : j];
            const std::int32_t a = face[k == 0 ? m - 1 : k - 1], b = face[after(next, m)];
            if ((above[i] >= 0 && above[i] != a) || (above[j] >= 0 && above[j] != b)) return false;
            above[i] = a, above[j] = b;
        }
    }
    for (std::size_t i = 0; i < n; ++i)
        if (facesOf[i] != 1 || above[i] < 0 || spotOf(above[i]) != none) return false;
    return true;
}

// Vertices of a face of the cell, seen from inside with the right hand.
void inward(const PolyMesh& mesh, std::int32_t f, std::int32_t cell, std::span<std::int32_t> out) {
    const Span face = mesh.face(f);
    std::copy(face.begin(), face.end(), out.begin());
    if (mesh.owner[static_cast<std::size_t>(f)] == cell) std::reverse(out.begin() + 1, out.end());
}

bool allDistinct(std::span<const std::int32_t> points) {
    for (std::size_t i = 0; i < points.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
            if (points[i] == points[j]) return false;
    return true;
}

// True if all faces with n vertices but the base hold only the given points.
bool closedBy(const PolyMesh& mesh, Span cellFaces, std::int32_t base, std::span<const std::int32_t> points,
              std::size_t n) {
    for (const std::int32_t f : cellFaces) {
        if (f == base || mesh.face(f).size() != n) continue;
        for (const std::int32_t v : mesh.face(f))
            if (!holds(points, v)) return false;
    }
    return true;
}

// Prism over a base of n points: hexahedron (n = 4) and wedge (n = 3).
CellShape prism(const PolyMesh& mesh, Span cellFaces, std::int32_t cell, std::int32_t base, std::size_t n) {
    CellShape shape;
    const std::span<std::int32_t> points(shape.points.data(), 2 * n), ring = points.first(n),
                                                                      above = points.last(n);
    inward(mesh, base, cell, ring);
    if (!raise(mesh, cellFaces, base, ring, above) || !allDistinct(points)) return {};
    if (!closedBy(mesh, cellFaces, base, points, n)) return {};
    if (n == 3) { // VTK's wedge has its base seen from outside
        std::swap(shape.points[1], shape.points[2]);
        std::swap(shape.points[4], shape.points[5]);
    }
    shape.type = n == 4 ? VtkCell::hexahedron : VtkCell::wedge;
    shape.pointCount = 2 * n;
    return shape;
}

// Cone over a base of n points: pyramid (n = 4) and tetrahedron (n = 3).
CellShape cone(const PolyMesh& mesh, Span cellFaces, std::int32_t cell, std::int32_t base, std::size_t n) {
    CellShape shape;
    const std::span<std::int32_t> ring(shape.points.data(), n);
    std::array<std::int32_t, 4> above{};
    inward(mesh, base, cell, ring);
    if (!raise(mesh, cellFaces, base, ring, std::span(above).first(n)) || !allDistinct(ring)) return {};
    if (std::any_of(above.begin(), above.begin() + static_cast<std::ptrdiff_t>(n),
                    [&](auto v) { return v != above[0]; }))
        return {};
    shape.points[n] = above[0];
    shape.type = n == 4 ? VtkCell::pyramid : VtkCell::tetra;
    shape.pointCount = n + 1;
    return shape;
}

} // namespace

CellShape shapeOf(const PolyMesh& mesh, std::span<const std::int32_t> cellFaces, std::int32_t cell) {
    if (cellFaces.size() < 4 || cellFaces.size() > 6) return {};
    std::size_t triangles = 0, quads = 0;
    std::int32_t triangle = -1, quad = -1;
    for (const std::int32_t f : cellFaces) {
        const std::size_t n = mesh.face(f).size();
        if (n == 3 && triangles++ == 0) triangle = f;
        if (n == 4 && quads++ == 0) quad = f;
        if (n > 4) return {};
    }
    if (quads == 6 && triangles == 0) return prism(mesh, cellFaces, cell, quad, 4);
    if (quads == 3 && triangles == 2) return prism(mesh, cellFaces, cell, triangle, 3);
    if (quads == 1 && triangles == 4) return cone(mesh, cellFaces, cell, quad, 4);
    if (quads == 0 && triangles == 4) return cone(mesh, cellFaces, cell, triangle, 3);
    return {};
}

void cellPoints(const PolyMesh& mesh, std::span<const std::int32_t> cellFaces,
                std::vector<std::int32_t>& out) {
    out.clear();
    for (const std::int32_t f : cellFaces) out.insert(out.end(), mesh.face(f).begin(), mesh.face(f).end());
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
}

void appendFaceStream(const PolyMesh& mesh, std::span<const std::int32_t> cellFaces, std::int32_t cell,
                      std::vector<std::int32_t>& out) {
    out.push_back(static_cast<std::int32_t>(cellFaces.size()));
    for (const std::int32_t f : cellFaces) {
        const Span face = mesh.face(f);
        out.push_back(static_cast<std::int32_t>(face.size()));
        if (mesh.owner[static_cast<std::size_t>(f)] == cell)
            out.insert(out.end(), face.begin(), face.end());
        else
            out.insert(out.end(), face.rbegin(), face.rend());
    }
}

} // namespace i2b
