#include "i2b/layers/warp.h"
#include "i2b/core/parallel.h"
#include "i2b/front/replace_faces.h"
#include <algorithm>
#include <array>

namespace i2b {
namespace {

using Index = std::size_t;
using Polygon = std::vector<std::int32_t>; // vertices
constexpr double leastShare = 0.2;   // centreShare() of cells that stand as they are
constexpr double leastHeight = 0.05; // of a thin cell's: its centre's over the triangles of its faces
constexpr Index mostVertices = 16;   // of a face
constexpr double soundCorner = 0.15; // scaled Jacobian; cuts that leave as much are chosen by how near to the geometry they run
constexpr double leastCorner = 0.02; // no cut leaves less

struct Polygon3 { // a face as OpenFOAM measures it
    Vec3 area, centre; // m^2, m
};

// Of the triangles from the mean of the vertices, the centre by their sizes.
Polygon3 measured(std::span<const Vec3> x) {
    Vec3 mean;
    for (const Vec3& p : x) mean += p;
    mean *= 1.0 / static_cast<double>(x.size());
    Vec3 twice, moment;
    double size = 0;
    for (Index i = 0; i < x.size(); ++i) {
        const Vec3 a = x[i] - mean, b = x[i + 1 == x.size() ? 0 : i + 1] - mean, n = cross(a, b);
        const double s = norm(n);
        twice += n, moment += (a + b) * (s / 3), size += s;
    }
    return {twice * 0.5, size > 0 ? mean + moment / size : mean};
}

struct Cut {
    Index from = 0, to = 0; // places in the polygon
    double corner = leastCorner;
    double off = 0;         // m, of its middle to the geometry
};

bool isBetter(const Cut& a, const Cut& b) {
    const bool soundA = a.corner >= soundCorner, soundB = b.corner >= soundCorner;
    if (soundA != soundB) return soundA;
    return soundA ? a.off < b.off : a.corner > b.corner;
}

class Cutter {
  public:
    Cutter(const Front& front, const LayerStack& stack, const SurfaceIndex& index) : front_(front), stack_(stack), index_(index) {}

    // Pieces of a polygon onto out, until they are small enough for their stacks, or all triangles, or no cut is left.
    void pieces(const Polygon& polygon, bool triangles, std::vector<Polygon>& out) const {
        if (polygon.size() > 3 && (triangles || !isFlat(polygon))) {
            if (const Cut cut = bestCut(polygon); cut.to > cut.from) {
                const auto at = [&](Index i) { return polygon.begin() + static_cast<std::ptrdiff_t>(i); };
                Polygon one(at(cut.from), at(cut.to) + 1), other(at(cut.to), polygon.end());
                other.insert(other.end(), polygon.begin(), at(cut.from) + 1);
                pieces(one, triangles, out);
                pieces(other, triangles, out);
                return;
            }
        }
        out.push_back(polygon);
    }

  private:
    // Are the centres of all layers on a polygon well inside?
    bool isFlat(const Polygon& polygon) const {
        const Index n = polygon.size();
        int cells = maxStack + 1;
        for (const std::int32_t v : polygon) cells = std::min(cells, stack_.pointsOf(static_cast<Index>(v)));
        std::vector<Vec3> points(n * static_cast<Index>(cells));
        for (Index i = 0; i < n; ++i) {
            const auto v = static_cast<Index>(polygon[i]);
            std::array<Vec3, maxStack + 1> column;
            placeLayers(stack_, v, front_.front[v], front_.wall(v), column.data());
            const auto last = static_cast<Index>(stack_.pointsOf(v)) - 1;
            for (Index k = 0; k < static_cast<Index>(cells); ++k) points[k * n + i] = column[last - k];
        }
        const auto level = [&](int k) { return std::span<const Vec3>(&points[static_cast<Index>(k) * n], n); };
        std::array<ThinCell, maxStack + 1> cell;
        for (int k = 0; k + 1 < cells; ++k) {
            cell[static_cast<Index>(k)] = thinCell(level(k), level(k + 1));
            if (!(cell[static_cast<Index>(k)].centreShare > leastShare)) return false;
        }
        // Nodes of few layers that fill the room are moved until their faces divide; those of thin layers cannot be.
        for (int k = 0; k < cells && stack_.areThin(); ++k) {
            if (!divides(level(k), k > 0 ? &cell[static_cast<Index>(k - 1)] : nullptr, k + 1 < cells ? &cell[static_cast<Index>(k)] : nullptr)) return false;
        }
        return true;
    }
    // Do the centres of the cells below and above see the triangles around a face's centre from the right side, and has the face a
    // vertex from which it divides into such?
    static bool divides(std::span<const Vec3> x, const ThinCell* below, const ThinCell* above) {
        const Index n = x.size();
        const auto sees = [](const ThinCell& cell, double side, const Vec3& from, const Vec3& up) {
            return side * dot(up, cell.centre - from) > leastHeight * cell.height;
        };
        const auto isSeen = [&](const Vec3& from, Index i, Index next) {
            const Vec3 up = normalized(cross(x[next % n] - from, x[i % n] - from)); // faces go round as seen from the wall
            return (!below || sees(*below, -1, from, up)) && (!above || sees(*above, 1, from, up));
        };
        const Vec3 centre = measured(x).centre;
        for (Index i = 0; i < n; ++i)
            if (!isSeen(centre, i, i + 1)) return false;
        for (Index base = 0; base < n; ++base) {
            bool good = true;
            for (Index i = 1; i + 1 < n && good; ++i) good = isSeen(x[base], base + i, base + i + 1);
            if (good) return true;
        }
        return false;
    }
    double cornerAt(std::int32_t vertex, std::int32_t before, std::int32_t next) const {
        return front_.cornerAt(static_cast<Index>(vertex), static_cast<Index>(before), static_cast<Index>(next));
    }
    // The piece from one vertex over the last and the first one to another.
    bool isOnOneEdgeRound(const Polygon& p, Index from, Index to) const {
        if (p.size() - from + to + 1 > 5) return false; // two ends, what hangs between them, and a vertex in each half
        Polygon piece(p.begin() + static_cast<std::ptrdiff_t>(from), p.end());
        piece.insert(piece.end(), p.begin(), p.begin() + static_cast<std::ptrdiff_t>(to) + 1);
        return front_.areOnOneEdge(piece);
    }
    Cut bestCut(const Polygon& p) const {
        const Index n = p.size();
        Cut best;
        for (Index i = 0; i + 2 < n; ++i) {
            for (Index j = i + 2; j < n; ++j) {
                if (i == 0 && j + 1 == n) continue;
                if (front_.areOnOneEdge({&p[i], j - i + 1}) || isOnOneEdgeRound(p, j, i)) continue;
                const auto wrapped = [&](Index k) { return p[k % n]; };
                Cut cut{i, j, 1, 0};
                for (const double corner : {cornerAt(p[i], p[j], wrapped(i + 1)), cornerAt(p[i], wrapped(i + n - 1), p[j]),
                                            cornerAt(p[j], wrapped(j + n - 1), p[i]), cornerAt(p[j], p[i], wrapped(j + 1))})
                    cut.corner = std::min(cut.corner, corner);
                if (j == i + 2) cut.corner = std::min(cut.corner, cornerAt(p[i + 1], p[i], p[j])); // the tips of triangles
                if (i + n == j + 2) cut.corner = std::min(cut.corner, cornerAt(wrapped(j + 1), p[j], p[i]));
                if (cut.corner <= leastCorner) continue;
                if (cut.corner >= soundCorner) {
                    const auto a = static_cast<Index>(p[i]), b = static_cast<Index>(p[j]);
                    const Vec3 middle = (front_.wall(a) + front_.wall(b)) * 0.5;
                    const ClosestPoint c = index_.closest(middle, front_.h[a]);
                    cut.off = c ? norm(c.point - middle) : front_.h[a];
                }
                if (best.to == 0 || isBetter(cut, best)) best = cut;
            }
        }
        return best;
    }

    const Front& front_;
    const LayerStack& stack_;
    const SurfaceIndex& index_;
};

} // namespace

ThinCell thinCell(std::span<const Vec3> low, std::span<const Vec3> high) {
    const Index n = low.size();
    std::array<Polygon3, mostVertices + 2> faces; // out of the cell; of the low one, whose points go round as seen from the wall
    faces[n] = measured(low), faces[n + 1] = measured(high);
    faces[n + 1].area *= -1;
    for (Index i = 0; i < n; ++i) {
        const Index next = i + 1 == n ? 0 : i + 1;
        faces[i] = measured(std::array{low[next], low[i], high[i], high[next]});
    }
    Vec3 estimate;
    for (Index i = 0; i < n + 2; ++i) estimate += faces[i].centre;
    estimate *= 1.0 / static_cast<double>(n + 2);
    Vec3 moment;
    double volume = 0;
    for (Index i = 0; i < n + 2; ++i) {
        const double v = dot(faces[i].area, faces[i].centre - estimate);
        moment += (faces[i].centre - estimate) * (0.75 * v), volume += v;
    }
    if (!(volume > 0)) return {};
    const Vec3 centre = estimate + moment / volume;
    const double below = dot(normalized(faces[n].area), faces[n].centre - centre), above = dot(normalized(faces[n + 1].area), faces[n + 1].centre - centre);
    const double height = dot(normalized(faces[n + 1].area), faces[n + 1].centre - faces[n].centre);
    return {centre, height, height > 0 ? std::min(below, above) / height : -1};
}

namespace {

// wanted: per face; triangles: cut to them.
std::size_t cutFaces(Front& front, const LayerStack& stack, const SurfaceIndex& index, const std::vector<std::uint8_t>& wanted, bool triangles) {
    const Cutter cutter(front, stack, index);
    std::vector<std::vector<Polygon>> pieces(front.ownerCell.size());
    parallelFor(pieces.size(), [&](Index f) {
        if (!wanted[f]) return;
        Polygon polygon;
        for (auto v : front.mesh.fv_range(FrontMesh::FaceHandle(static_cast<int>(f)))) polygon.push_back(v.idx());
        if (polygon.size() > 3 && polygon.size() <= mostVertices) cutter.pieces(polygon, triangles, pieces[f]);
    });
    std::vector<FaceCut> cuts;
    for (Index f = 0; f < pieces.size(); ++f) {
        if (pieces[f].size() > 1) cuts.push_back({static_cast<std::int32_t>(f), std::move(pieces[f])});
    }
    replaceFaces(front, cuts);
    return cuts.size();
}

} // namespace

std::size_t cutWarped(Front& front, const LayerStack& stack, const SurfaceIndex& index) {
    if (stack.count == 1 && stack.uniform()) return 0;
    std::vector<std::uint8_t> layered(stack.faces);
    for (Index f = 0; f < layered.size(); ++f) layered[f] = stack.cellsOf(f) > 1;
    return cutFaces(front, stack, index, layered, false);
}

std::size_t cutUnder(Front& front, const LayerStack& stack, const SurfaceIndex& index, const std::vector<std::int32_t>& cells) {
    std::vector<std::uint8_t> wanted(stack.faces, 0);
    for (const std::int32_t cell : cells) wanted[stack.faceOfCell(static_cast<Index>(cell))] = 1;
    return cutFaces(front, stack, index, wanted, true);
}

} // namespace i2b
