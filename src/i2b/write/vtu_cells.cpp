#include "i2b/write/vtu_cells.h"
#include <algorithm>

namespace i2b {
namespace {

using Span = std::span<const std::int32_t>;

// Where v stands among the ring's N points; N: nowhere. N is known to the compiler, so that it compares all at once.
template <std::size_t N>
std::size_t spotIn(const std::array<std::int32_t, N>& ring, std::int32_t v) {
    std::size_t spot = N;
    for (std::size_t i = 0; i < N; ++i) spot = ring[i] == v ? i : spot;
    return spot;
}

// The points above the base polygon: each edge of it is in one other face, which leads up from both its ends. False where
// these disagree, or a point above is one of the base. No face has more than four vertices.
template <std::size_t N>
bool raise(const PolyMesh& mesh, Span cellFaces, std::int32_t base, const std::array<std::int32_t, N>& ring,
           std::array<std::int32_t, N>& above) {
    above.fill(-1);
    const auto after = [](std::size_t i, std::size_t of) { return i + 1 == of ? 0 : i + 1; };
    std::array<int, N> facesOf{}; // per edge of the base
    for (const std::int32_t f : cellFaces) {
        if (f == base) continue;
        const Span face = mesh.face(f);
        const std::size_t m = face.size();
        std::array<std::size_t, 4> spot;
        bool meets = false;
        for (std::size_t k = 0; k < m; ++k) {
            spot[k] = spotIn(ring, face[k]);
            meets = meets || spot[k] != N;
        }
        for (std::size_t k = 0; meets && k < m; ++k) {
            const std::size_t next = after(k, m), i = spot[k], j = spot[next];
            if (i == N || j == N || (after(i, N) != j && after(j, N) != i)) continue;
            ++facesOf[after(i, N) == j ? i : j];
            const std::int32_t a = face[k == 0 ? m - 1 : k - 1], b = face[after(next, m)];
            if ((above[i] >= 0 && above[i] != a) || (above[j] >= 0 && above[j] != b)) return false;
            above[i] = a, above[j] = b;
        }
    }
    for (std::size_t i = 0; i < N; ++i)
        if (facesOf[i] != 1 || above[i] < 0 || spotIn(ring, above[i]) != N) return false;
    return true;
}

// Vertices of a face of the cell, seen from inside with the right hand.
template <std::size_t N>
std::array<std::int32_t, N> inward(const PolyMesh& mesh, std::int32_t f, std::int32_t cell) {
    std::array<std::int32_t, N> ring;
    std::copy_n(mesh.face(f).begin(), N, ring.begin());
    if (mesh.owner[static_cast<std::size_t>(f)] == cell) std::reverse(ring.begin() + 1, ring.end());
    return ring;
}

template <std::size_t N>
bool allDistinct(const std::array<std::int32_t, N>& points) {
    for (std::size_t i = 0; i < N; ++i)
        for (std::size_t j = 0; j < i; ++j)
            if (points[i] == points[j]) return false;
    return true;
}

// True if all faces with N vertices but the base hold only points of the ring or above it.
template <std::size_t N>
bool closedBy(const PolyMesh& mesh, Span cellFaces, std::int32_t base, const std::array<std::int32_t, N>& ring,
              const std::array<std::int32_t, N>& above) {
    for (const std::int32_t f : cellFaces) {
        if (f == base || mesh.face(f).size() != N) continue;
        for (const std::int32_t v : mesh.face(f))
            if (spotIn(ring, v) == N && spotIn(above, v) == N) return false;
    }
    return true;
}

// Prism over a base of N points: hexahedron (N = 4) and wedge (N = 3).
template <std::size_t N>
CellShape prism(const PolyMesh& mesh, Span cellFaces, std::int32_t cell, std::int32_t base) {
    std::array<std::int32_t, N> ring = inward<N>(mesh, base, cell), above;
    if (!raise(mesh, cellFaces, base, ring, above) || !allDistinct(ring) || !allDistinct(above)) return {}; // none is in both
    if (!closedBy(mesh, cellFaces, base, ring, above)) return {};
    if constexpr (N == 3) { // VTK's wedge has its base seen from outside
        std::swap(ring[1], ring[2]);
        std::swap(above[1], above[2]);
    }
    CellShape shape;
    std::copy(above.begin(), above.end(), std::copy(ring.begin(), ring.end(), shape.points.begin()));
    shape.type = N == 4 ? VtkCell::hexahedron : VtkCell::wedge;
    shape.pointCount = 2 * N;
    return shape;
}

// Cone over a base of N points: pyramid (N = 4) and tetrahedron (N = 3).
template <std::size_t N>
CellShape cone(const PolyMesh& mesh, Span cellFaces, std::int32_t cell, std::int32_t base) {
    const std::array<std::int32_t, N> ring = inward<N>(mesh, base, cell);
    std::array<std::int32_t, N> above;
    if (!raise(mesh, cellFaces, base, ring, above) || !allDistinct(ring)) return {};
    if (std::any_of(above.begin(), above.end(), [&](auto v) { return v != above[0]; })) return {};
    CellShape shape;
    std::copy(ring.begin(), ring.end(), shape.points.begin());
    shape.points[N] = above[0];
    shape.type = N == 4 ? VtkCell::pyramid : VtkCell::tetra;
    shape.pointCount = N + 1;
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
    if (quads == 6 && triangles == 0) return prism<4>(mesh, cellFaces, cell, quad);
    if (quads == 3 && triangles == 2) return prism<3>(mesh, cellFaces, cell, triangle);
    if (quads == 1 && triangles == 4) return cone<4>(mesh, cellFaces, cell, quad);
    if (quads == 0 && triangles == 4) return cone<3>(mesh, cellFaces, cell, triangle);
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
