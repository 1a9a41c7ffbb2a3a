#include "i2b/assemble/assemble.h"
#include "i2b/assemble/divided_edges.h"
#include "i2b/core/error.h"
#include "i2b/front/convex_cells.h"
#include <algorithm>
#include <bit>
#include <fmt/format.h>
#include <numeric>
#include <span>
#include <utility>

namespace i2b {
namespace {

constexpr std::array<const char*, 6> sideNames{"xMin", "xMax", "yMin", "yMax", "zMin", "zMax"};

// Faces and face vertices, counted first, filled after: internal ones, and those of the six domain sides.
struct Counts {
    std::array<std::int64_t, 7> faces{}, vertices{}; // 0: internal, 1 + side
};

// Counts faces. Cells far from all others than those of their own size are counted by the bit (LatticeMesh::Reader::deepCells()).
struct Counter {
    static constexpr bool counts = true;
    Counts& sum;

    void add(std::size_t kind, std::int32_t, std::int32_t, std::span<const std::int32_t> points) {
        ++sum.faces[kind];
        sum.vertices[kind] += static_cast<std::int64_t>(points.size());
    }
    void addDeep(std::int64_t cells) { sum.faces[0] += 3 * cells, sum.vertices[0] += 12 * cells; }
};

// Where the next face of each kind goes.
struct Cursor {
    static constexpr bool counts = false;
    Counts at;
    PolyMesh* mesh = nullptr;

    void add(std::size_t kind, std::int32_t owner, std::int32_t neighbour, std::span<const std::int32_t> points) {
        const auto f = static_cast<std::size_t>(at.faces[kind]++);
        auto& v = at.vertices[kind];
        std::copy(points.begin(), points.end(), mesh->faceVertices.begin() + v);
        v += static_cast<std::int64_t>(points.size());
        mesh->faceOffsets[f + 1] = static_cast<std::uint32_t>(v);
        mesh->owner[f] = owner;
        if (kind == 0) mesh->neighbour[f] = neighbour;
    }
};

struct Pending { // an internal face waiting to be put in order of its neighbour
    std::int32_t neighbour = 0;
    std::uint8_t n = 0;
    std::array<std::int32_t, 16> points{};
    std::span<const std::int32_t> span() const { return {points.data(), n}; }
};

// Of a prism: the edge of the front from u to w and the front face beyond it, or -1.
struct PrismSide { int other, u, w; };
// A piece of a side between two cells of layers: cells between it and the wall in the higher of the two stacks.
struct SidePiece {
    std::int32_t neighbour = 0;
    const PrismSide* side = nullptr;
    int below = 0;
};
// What prismFaces() works with, kept from face to face for its memory.
struct Scratch {
    std::vector<PrismSide> sides;
    std::vector<SidePiece> pieces;
    std::vector<std::int32_t> points;
};

class Assembler {
  public:
    explicit Assembler(const AssembleInput& in)
        : in_(in), coreCells_(static_cast<std::int32_t>(in.lattice.cellCount())),
          corePoints_(in.front.corePoints + static_cast<std::int32_t>(in.front.inserted.size())),
          frontFaces_(in.front.ownerCell.size()), divided_(in.front) {}

    PolyMesh run();

  private:
    // k = 0: next to the front; the last one: at the wall.
    std::int32_t layerCell(std::size_t face, int k) const {
        return coreCells_ + static_cast<std::int32_t>(in_.layers.cellOffset(face)) + k;
    }
    std::int32_t wallCell(std::size_t face) const { return layerCell(face, in_.layers.cellsOf(face) - 1); }
    // level: cells between the point and the wall; 0: on the wall; pointsOf(vertex): on the front.
    std::int32_t layerPoint(int vertex, int level) const {
        const auto v = static_cast<std::size_t>(vertex);
        const int points = in_.layers.pointsOf(v);
        return level == points ? in_.front.corePoint[v] : corePoints_ + static_cast<std::int32_t>(in_.layers.pointOffset(v)) + points - 1 - level;
    }
    template <class Sink>
    void coreFaces(int level, std::size_t node, LatticeMesh::Reader& reader, Sink& sink) const;
    template <class Sink>
    void prismFaces(std::size_t face, Scratch& scratch, Sink& sink) const;
    void addPieces(std::size_t face, int k, const PrismSide& side, std::vector<SidePiece>& out) const;
    void sidePolygon(const SidePiece& piece, int cells, std::vector<std::int32_t>& out) const;
    void polygon(std::size_t face, int level, Pending& p) const;
    int sideOf(int u, int w) const;
    void layOut(PolyMesh& mesh);
    void fill(PolyMesh& mesh);
    void wallPatches(PolyMesh& mesh);
    void cellData(PolyMesh& mesh) const;
    RawVector<Vec3> placePoints() const;

    struct Chunk { // of nodes of one level, or of front faces (level -1)
        int level = -1;
        std::size_t begin = 0, end = 0;
        Counts counts;
    };
    template <class Sink>
    void chunkFaces(const Chunk& chunk, Sink& sink) const;

    const AssembleInput& in_;
    std::int32_t coreCells_, corePoints_;
    std::size_t frontFaces_;
    DividedEdges divided_;
    std::vector<Chunk> chunks_;
    std::int64_t sideFaces_ = 0, sideVertices_ = 0; // faces before the walls
};

// level -1: the front.
void Assembler::polygon(std::size_t face, int level, Pending& p) const {
    p.n = 0;
    for (auto v : in_.front.mesh.fv_range(FrontMesh::FaceHandle(static_cast<int>(face)))) {
        p.points[p.n++] = level < 0 ? in_.front.corePoint[static_cast<std::size_t>(v.idx())] : layerPoint(v.idx(), level);
    }
}

int Assembler::sideOf(int u, int w) const {
    const int common = in_.front.outside[static_cast<std::size_t>(u)] & in_.front.outside[static_cast<std::size_t>(w)];
    return std::countr_zero(static_cast<unsigned>(common));
}

// Every face that a node's cells own, cell by cell.
template <class Sink>
void Assembler::coreFaces(int level, std::size_t node, LatticeMesh::Reader& reader, Sink& sink) const {
    const RankedMask& cells = in_.lattice.cells(level);
    const Index3 o = toIndex(cells.leaf(node).origin());
    auto rank = static_cast<std::int32_t>(cells.leafFirst(node));
    std::vector<Pending> pending;
    auto next = static_cast<std::size_t>(
        std::lower_bound(in_.front.ownerCell.begin(), in_.front.ownerCell.end(), rank) - in_.front.ownerCell.begin());
    const LeafBits deep = reader.deepCells(level, node);
    if constexpr (Sink::counts) sink.addDeep(bits::count(deep));
    bits::forEach(leafBits(&cells.leaf(node)), [&](int x, int y, int z) {
        if (bits::test(deep, bits::offset(x, y, z))) {
            if constexpr (!Sink::counts) {
                reader.upperFaces(level, {o[0] + x, o[1] + y, o[2] + z},
                                  [&](std::int32_t other, const std::array<std::int32_t, 4>& points) { sink.add(0, rank, other, points); });
            }
            ++rank;
            return;
        }
        pending.clear();
        const auto take = [&](const CellFace& face) {
            Pending p;
            p.n = face.vertices;
            std::copy_n(face.points.begin(), p.n, p.points.begin());
            if (face.kind != FaceKind::front) p.n = static_cast<std::uint8_t>(divided_.addTo(p.points, p.n));
            if (face.kind == FaceKind::side) return sink.add(std::size_t(1) + face.side, rank, 0, p.span());
            if (face.kind == FaceKind::internal) {
                p.neighbour = static_cast<std::int32_t>(face.other);
                pending.push_back(p);
                return;
            }
            for (int i = in_.front.pieces[next]; i > 0; --i, ++next) { // the fit may have split it in two
                polygon(next, -1, p);
                p.neighbour = layerCell(next, 0);
                pending.push_back(p);
            }
        };
        reader.faces(level, {o[0] + x, o[1] + y, o[2] + z}, take, rank);
        std::sort(pending.begin(), pending.end(), [](const Pending& a, const Pending& b) { return a.neighbour < b.neighbour; });
        for (const Pending& p : pending) sink.add(0, rank, p.neighbour, p.span());
        ++rank;
    });
}

// The pieces of a side of the k-th cell of a face: the innermost cell lies beside all cells of the other stack from its own
// height on.
void Assembler::addPieces(std::size_t face, int k, const PrismSide& side, std::vector<SidePiece>& out) const {
    const auto other = static_cast<std::size_t>(side.other);
    const int mine = in_.layers.cellsOf(face), others = side.other < 0 ? mine : in_.layers.cellsOf(other);
    const int below = mine - 1 - k, last = k == 0 ? std::max(mine, others) - 1 : below;
    for (int b = last; b >= below; --b) {
        const std::int32_t neighbour = side.other < 0 ? 0 : layerCell(other, others - 1 - std::min(b, others - 1));
        out.push_back({neighbour, &side, b});
    }
}

// Along the front or the layer above, down at w, along the layer below, up at u; with all points that the stacks around
// have there. cells: of the higher stack beside the piece.
void Assembler::sidePolygon(const SidePiece& piece, int cells, std::vector<std::int32_t>& out) const {
    const auto [other, u, w] = *piece.side;
    const auto topOf = [&](int v) {
        return piece.below + 1 < cells ? piece.below + 1 : in_.layers.pointsOf(static_cast<std::size_t>(v));
    };
    const int topU = topOf(u), topW = topOf(w);
    out.clear();
    out.push_back(layerPoint(u, topU));
    for (int level = topW; level >= piece.below; --level) out.push_back(layerPoint(w, level));
    for (int level = piece.below; level < topU; ++level) out.push_back(layerPoint(u, level));
}

template <class Sink>
void Assembler::prismFaces(std::size_t face, Scratch& scratch, Sink& sink) const {
    auto& [sides, pieces, points] = scratch;
    sides.clear();
    const FrontMesh& mesh = in_.front.mesh;
    for (auto he : mesh.fh_range(FrontMesh::FaceHandle(static_cast<int>(face)))) {
        const auto other = mesh.opposite_face_handle(he);
        sides.push_back({other.is_valid() ? other.idx() : -1, mesh.from_vertex_handle(he).idx(), mesh.to_vertex_handle(he).idx()});
    }
    std::stable_sort(sides.begin(), sides.end(), [](const PrismSide& a, const PrismSide& b) { return a.other < b.other; });
    const auto lower = [](const SidePiece& a, const SidePiece& b) { return a.neighbour < b.neighbour; };
    const int cells = in_.layers.cellsOf(face);
    for (int k = 0; k < cells; ++k) {
        const std::int32_t owner = layerCell(face, k);
        if (k + 1 < cells) {
            Pending p;
            polygon(face, cells - 1 - k, p);
            sink.add(0, owner, owner + 1, p.span());
        }
        pieces.clear();
        for (const PrismSide& s : sides) {
            if (s.other < 0 || s.other > static_cast<int>(face)) addPieces(face, k, s, pieces);
        }
        if (!std::is_sorted(pieces.begin(), pieces.end(), lower)) std::stable_sort(pieces.begin(), pieces.end(), lower);
        for (const SidePiece& piece : pieces) {
            const PrismSide& s = *piece.side;
            sidePolygon(piece, s.other < 0 ? cells : std::max(cells, in_.layers.cellsOf(static_cast<std::size_t>(s.other))), points);
            sink.add(s.other < 0 ? static_cast<std::size_t>(1 + sideOf(s.u, s.w)) : std::size_t(0), owner, piece.neighbour, points);
        }
    }
}

template <class Sink>
void Assembler::chunkFaces(const Chunk& chunk, Sink& sink) const {
    if (chunk.level < 0) {
        Scratch scratch;
        for (std::size_t f = chunk.begin; f < chunk.end; ++f) prismFaces(f, scratch, sink);
        return;
    }
    LatticeMesh::Reader reader(in_.lattice);
    for (std::size_t node = chunk.begin; node < chunk.end; ++node) coreFaces(chunk.level, node, reader, sink);
}

// Counts per chunk, then turns them into starting places: internal faces of all chunks, then side by side.
void Assembler::layOut(PolyMesh& mesh) {
    for (int l = 0; l < in_.lattice.levels(); ++l) {
        for (std::size_t n = in_.lattice.cells(l).leafCount(), b = 0; b < n; b += 16) chunks_.push_back({l, b, std::min(n, b + 16), {}});
    }
    for (std::size_t b = 0; b < frontFaces_; b += 2048) chunks_.push_back({-1, b, std::min(frontFaces_, b + 2048), {}});
    parallelFor(chunks_.size(), [&](std::size_t c) {
        Counter counter{chunks_[c].counts};
        chunkFaces(chunks_[c], counter);
    }, 1);
    std::int64_t faces = 0, vertices = 0;
    for (std::size_t kind = 0; kind < 7; ++kind) {
        const std::int64_t start = faces;
        for (Chunk& chunk : chunks_) {
            faces += std::exchange(chunk.counts.faces[kind], faces);
            vertices += std::exchange(chunk.counts.vertices[kind], vertices);
        }
        if (kind == 0) {
            mesh.neighbour.resize(static_cast<std::size_t>(faces));
        } else if (faces > start) {
            mesh.patches.push_back({sideNames[kind - 1], "patch", static_cast<std::int32_t>(start),
                                    static_cast<std::int32_t>(faces - start)});
        }
    }
    std::int64_t wall = vertices;
    for (std::size_t f = 0; f < frontFaces_; ++f) wall += in_.front.mesh.valence(FrontMesh::FaceHandle(static_cast<int>(f)));
    sideFaces_ = faces;
    sideVertices_ = vertices;
    if (wall >= std::numeric_limits<std::int32_t>::max()) {
        throw Error(ErrorKind::input, fmt::format("{} faces are more than a mesh of 32-bit labels can hold", faces), "",
                    "give a larger --size");
    }
    const auto all = static_cast<std::size_t>(faces) + frontFaces_;
    mesh.faceOffsets.resize(all + 1);
    mesh.faceOffsets[0] = 0;
    mesh.owner.resize(all);
    mesh.faceVertices.resize(static_cast<std::size_t>(wall));
}

void Assembler::fill(PolyMesh& mesh) {
    parallelFor(
        chunks_.size(),
        [&](std::size_t c) {
            Cursor cursor{chunks_[c].counts, &mesh};
            chunkFaces(chunks_[c], cursor);
        },
        1);
}

// Wall faces part by part, each in the order of the front.
void Assembler::wallPatches(PolyMesh& mesh) {
    std::vector<std::int32_t> order(frontFaces_);
    std::iota(order.begin(), order.end(), 0);
    const auto partOf = [&](std::int32_t f) { return in_.front.part[static_cast<std::size_t>(f)]; };
    std::stable_sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) { return partOf(a) < partOf(b); });
    std::int64_t f = sideFaces_, v = sideVertices_;
    for (std::size_t i = 0; i < order.size(); ++i) {
        const std::int32_t part = partOf(order[i]);
        if (i == 0 || part != partOf(order[i - 1])) {
            mesh.patches.push_back({in_.parts[static_cast<std::size_t>(part)].name, "wall", static_cast<std::int32_t>(f), 0});
        }
        ++mesh.patches.back().count;
        Pending p;
        polygon(static_cast<std::size_t>(order[i]), 0, p);
        std::copy_n(p.points.begin(), p.n, mesh.faceVertices.begin() + v);
        v += p.n;
        mesh.faceOffsets[static_cast<std::size_t>(f) + 1] = static_cast<std::uint32_t>(v);
        mesh.owner[static_cast<std::size_t>(f++)] = wallCell(static_cast<std::size_t>(order[i]));
    }
}

void Assembler::cellData(PolyMesh& mesh) const {
    const auto cells = static_cast<std::size_t>(mesh.cells);
    mesh.cellLevel.resize(cells);
    mesh.cellLayer.assign(cells, 0);
    for (int l = 0; l < in_.lattice.levels(); ++l) {
        const auto finest = static_cast<std::uint8_t>(in_.lattice.levelOf(l).finest());
        in_.lattice.cells(l).forEach([&](std::int64_t rank, const Index3&) { mesh.cellLevel[std::size_t(rank)] = finest; });
    }
    const bool zoned = !in_.kept.zones.empty();
    if (zoned) {
        mesh.cellRegion.assign(cells, 0);
        for (std::size_t z = 0; z < in_.kept.zones.size(); ++z) {
            for (int l = 0; l < in_.lattice.levels(); ++l) {
                MaskReader zone(*in_.kept.zones[z][std::size_t(l)]);
                for (std::size_t n = 0; n < in_.lattice.cells(l).leafCount(); ++n) {
                    const MaskLeaf& leaf = in_.lattice.cells(l).leaf(n);
                    const LeafBits mine = leafBits(zone.probeConstLeaf(leaf.origin()));
                    auto rank = static_cast<std::size_t>(in_.lattice.cells(l).leafFirst(n));
                    bits::forEach(leafBits(&leaf), [&](int x, int y, int zz) {
                        if (bits::test(mine, bits::offset(x, y, zz))) mesh.cellRegion[rank] = static_cast<std::int32_t>(z);
                        ++rank;
                    });
                }
            }
        }
    }
    parallelFor(frontFaces_, [&](std::size_t f) {
        const auto owner = static_cast<std::size_t>(in_.front.ownerCell[f]);
        for (int k = 0, cells = in_.layers.cellsOf(f); k < cells; ++k) {
            const auto c = static_cast<std::size_t>(layerCell(f, k));
            mesh.cellLevel[c] = in_.front.level[f];
            mesh.cellLayer[c] = static_cast<std::uint8_t>(cells - k);
            if (zoned) mesh.cellRegion[c] = mesh.cellRegion[owner];
        }
    });
    if (!zoned) return;
    for (const std::string& name : in_.kept.zoneNames) mesh.zones.push_back({name, {}});
    for (std::int32_t c = 0; c < mesh.cells; ++c) mesh.zones[static_cast<std::size_t>(mesh.cellRegion[static_cast<std::size_t>(c)])].cells.push_back(c);
}

// Core points where the lattice (or, at a jump in level, little beside it) or the fit has them, then the layers' points, stack by stack.
RawVector<Vec3> Assembler::placePoints() const {
    const Front& front = in_.front;
    RawVector<Vec3> points = in_.lattice.latticePoints(in_.front.inserted.size() + in_.layers.points());
    raiseMiddles(in_.lattice, points);
    const auto core = static_cast<std::size_t>(corePoints_);
    points.resize(core + in_.layers.points());
    parallelFor(front.movedPoints.size(), [&](std::size_t i) {
        points[static_cast<std::size_t>(front.movedPoints[i])] = front.movedTo[i];
    });
    for (std::size_t v = 0; v < front.front.size(); ++v) { // serial: fans may share a point, and then agree on it
        points[static_cast<std::size_t>(front.corePoint[v])] = front.front[v];
    }
    parallelFor(front.front.size(), [&](std::size_t v) {
        placeLayers(in_.layers, v, front.front[v], front.wall(v), &points[core + in_.layers.pointOffset(v)]);
    });
    return points;
}

PolyMesh Assembler::run() {
    const double cells = double(coreCells_) + double(in_.layers.cells());
    const double points = double(corePoints_) + double(in_.layers.points());
    if (std::max(cells, points) >= 2147483647.0) {
        throw Error(ErrorKind::input, fmt::format("{:.0f} cells are more than a mesh of 32-bit labels can hold", cells), "",
                    "give a larger --size or fewer --layers");
    }
    PolyMesh mesh;
    mesh.cells = static_cast<std::int32_t>(cells);
    mesh.points = placePoints(); // first: they are resized on the way
    layOut(mesh);
    fill(mesh);
    wallPatches(mesh);
    cellData(mesh);
    return mesh;
}

} // namespace

PolyMesh assemble(const AssembleInput& input) { return Assembler(input).run(); }

} // namespace i2b
