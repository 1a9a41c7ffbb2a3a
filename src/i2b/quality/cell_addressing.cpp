#include "i2b/quality/cell_addressing.h"
#include <algorithm>

namespace i2b {
namespace {

using Index = std::size_t;

// Edge use by sorting, for cells with too many vertices for CellEdges.
struct EdgeUse {
    bool once = false, over = false;
};
EdgeUse sortedEdgeUse(const PolyMesh& mesh, std::span<const std::int32_t> faces) {
    std::vector<std::uint64_t> edges;
    for (const std::int32_t f : faces) {
        const std::span<const std::int32_t> v = mesh.face(f);
        for (Index i = 0; i < v.size(); ++i) {
            const std::int32_t a = v[i], b = v[i + 1 == v.size() ? 0 : i + 1];
            edges.push_back(std::uint64_t(std::uint32_t(std::min(a, b))) << 32 |
                            std::uint32_t(std::max(a, b)));
        }
    }
    std::sort(edges.begin(), edges.end());
    EdgeUse use;
    for (Index i = 0, j = 0; i < edges.size(); i = j) {
        while (j < edges.size() && edges[j] == edges[i]) ++j;
        use.once |= j - i == 1;
        use.over |= j - i > 2;
    }
    return use;
}

// Six quadrilaterals that are plainly a hexahedron: the other five join the first one's four vertices to four others, one
// each, so that all three faces at a vertex are those of a cube. Then each edge has two faces, and no list of edges is needed.
bool isPlainHex(const PolyMesh& mesh, std::span<const std::int32_t> faces) {
    const std::int32_t* v[6];
    for (Index i = 0; i < 6; ++i) v[i] = mesh.faceVertices.data() + mesh.faceOffsets[Index(faces[i])];
    const std::int32_t* const base = v[0];
    const auto corner = [&](std::int32_t p) { return p == base[0] ? 0 : p == base[1] ? 1 : p == base[2] ? 2 : p == base[3] ? 3 : -1; };
    if (base[0] == base[1] || base[0] == base[2] || base[0] == base[3] || base[1] == base[2] || base[1] == base[3] || base[2] == base[3])
        return false;
    std::int32_t above[4] = {-1, -1, -1, -1}; // the vertex that is joined to each of the first face
    unsigned sides = 0;                       // edges of the first face that have a side
    const std::int32_t* lid = nullptr;
    for (Index i = 1; i < 6; ++i) {
        int at[4];
        for (Index k = 0; k < 4; ++k) at[k] = corner(v[i][k]);
        Index first = 0; // of the two that are of the first face and follow each other
        while (first < 4 && !(at[first] >= 0 && at[(first + 1) % 4] >= 0)) ++first;
        if (first == 4) {
            if (lid != nullptr || at[0] + at[1] + at[2] + at[3] != -4) return false;
            lid = v[i];
            continue;
        }
        const Index second = (first + 1) % 4, third = (first + 2) % 4, fourth = (first + 3) % 4;
        if (at[third] >= 0 || at[fourth] >= 0) return false;
        const int a = at[first], b = at[second];
        const bool along = b == (a + 1) % 4;
        if (!along && a != (b + 1) % 4) return false;
        sides |= 1U << unsigned(along ? a : b);
        for (const auto& [below, p] : {std::pair(b, v[i][third]), std::pair(a, v[i][fourth])}) {
            if (above[below] >= 0 && above[below] != p) return false;
            above[below] = p;
        }
    }
    if (sides != 15U || lid == nullptr || above[0] == above[2] || above[1] == above[3]) return false;
    // The lid runs through the four above in their order, one way or the other, from wherever it starts.
    const Index start = lid[0] == above[0] ? 0 : lid[0] == above[1] ? 1 : lid[0] == above[2] ? 2 : 3;
    if (lid[0] != above[start] || lid[2] != above[(start + 2) % 4]) return false;
    const std::int32_t next = above[(start + 1) % 4], last = above[(start + 3) % 4];
    return above[start] != next && above[start] != last && above[(start + 2) % 4] != next && above[(start + 2) % 4] != last &&
           ((lid[1] == next && lid[3] == last) || (lid[1] == last && lid[3] == next));
}

bool disjoint(std::span<const std::int32_t> a, std::span<const std::int32_t> b) {
    for (const std::int32_t v : a)
        if (std::find(b.begin(), b.end(), v) != b.end()) return false;
    return true;
}

// By the number of triangles and quads alone where that settles it; vertices: of the cell.
void countShape(const PolyMesh& mesh, std::span<const std::int32_t> faces, int vertices, CellPart& part) {
    int triangles = 0, quads = 0;
    std::span<const std::int32_t> triangle[2];
    for (const std::int32_t f : faces) {
        const std::span<const std::int32_t> v = mesh.face(f);
        if (v.size() == 3)
            triangle[triangles++ % 2] = v;
        else if (v.size() == 4)
            ++quads;
    }
    CellShapes& s = part.shapes;
    const bool simple = Index(triangles + quads) == faces.size();
    if (simple && triangles == 0 && quads == 6)
        ++s.hexahedra;
    else if (simple && triangles == 4 && quads == 0)
        ++s.tetrahedra;
    else if (simple && triangles == 4 && quads == 1)
        ++s.pyramids;
    else if (simple && triangles == 2 && quads == 3 && vertices == 6 && disjoint(triangle[0], triangle[1]))
        ++s.prisms;
    else if (simple && triangles == 2 && quads == 4 && vertices == 7)
        ++s.wedges;
    else if (simple && triangles == 2 && quads == 2)
        ++s.tetWedges;
    else
        ++s.polyhedra, ++part.polyhedra[static_cast<std::int64_t>(faces.size())];
}

int internalFaces(const PolyMesh& mesh, std::span<const std::int32_t> faces) {
    int n = 0;
    for (const std::int32_t f : faces) n += f < mesh.internalFaces() ? 1 : 0;
    return n;
}

} // namespace

void CellAddressing::checkEdges(std::span<const std::int32_t> faces, std::int32_t cell, CellPart& part) {
    edges_.clear();
    bool fits = true;
    for (const std::int32_t f : faces)
        if (!edges_.addFace(mesh_.face(f))) {
            fits = false;
            break;
        }
    const EdgeUse use = fits ? EdgeUse{edges_.anyEdgeOnce(), edges_.anyEdgeOver()} : sortedEdgeUse(mesh_, faces);
    if (use.once) ++part.openByEdges;
    if (use.once || use.over) part.zipUp.hit(cell);
}

// Internal faces of a cell should lead to its higher neighbours in their order.
void CellAddressing::checkOrder(std::span<const std::int32_t> faces, std::int32_t cell, CellPart& part) {
    const std::int32_t internal = mesh_.internalFaces();
    std::int32_t lastCell = -1, lastFace = -1;
    bool ordered = true;
    scratch_.clear();
    for (const std::int32_t f : faces) {
        if (f >= internal) continue;
        const std::int32_t owner = mesh_.owner[Index(f)], neighbour = mesh_.neighbour[Index(f)];
        const std::int32_t other = neighbour == cell ? owner : neighbour;
        if (other <= cell) continue;
        ordered = ordered && other > lastCell && f > lastFace;
        lastCell = other, lastFace = f;
        scratch_.emplace_back(other, f);
    }
    if (ordered) return;
    std::stable_sort(scratch_.begin(), scratch_.end(), [](auto& a, auto& b) { return a.first < b.first; });
    bool multiple = false;
    for (Index i = 1; i < scratch_.size(); ++i) {
        const auto& [before, beforeFace] = scratch_[i - 1];
        const auto& [here, face] = scratch_[i];
        if (here == before) {
            multiple = true;
            part.unorderedFaces.push_back(beforeFace);
            part.unorderedFaces.push_back(face);
        } else if (face < beforeFace) {
            ++part.unordered;
            part.unorderedFaces.push_back(face);
        }
    }
    if (multiple) ++part.multiplyConnected;
}

void CellAddressing::measure(std::int32_t cell, std::span<const std::int32_t> faces, bool hex, CellPart& part) {
    if (faces.size() <= 3) part.illegal.hit(cell);
    if (!hex || !isPlainHex(mesh_, faces)) checkEdges(faces, cell, part);
    if (hex)
        ++part.shapes.hexahedra;
    else
        countShape(mesh_, faces, edges_.vertices(), part);
    checkOrder(faces, cell, part);
    const int internal = internalFaces(mesh_, faces);
    if (internal <= 1)
        part.oneInternal.hit(cell);
    else if (internal == 2)
        part.twoInternal.hit(cell);
}

} // namespace i2b
