#include "i2b/fit/deepen.h"
#include "i2b/core/flags.h"
#include "i2b/core/parallel.h"
#include "i2b/core/raw_fill.h"
#include "i2b/fit/corner.h"
#include "i2b/fit/fit.h"
#include "i2b/fit/store.h"
#include <algorithm>
#include <cmath>

namespace i2b {
namespace {

using Index = std::size_t;
constexpr double usual = 0.75;      // of h: so much and less the fit gives of itself
constexpr double most = 4;          // of h: no deeper, whatever is asked
constexpr double ofPassage = 0.33;  // share of the way to the wall on the other side
constexpr double ofDomain = 0.5;    // the same to a side of the domain
constexpr double squeeze = 0.35;    // share of its height that a core cell gives up
constexpr int leastRings = 3, mostRings = 12;
constexpr double slope = 0.4;       // by which depths of neighbours may differ, over the way between them
constexpr int smoothings = 2;       // of depths: the front keeps its steps, in which cells have their corners
constexpr int rounds = 8;           // of less depth at bad corners
constexpr double badCore = 2.5, badPrism = 4; // phi
constexpr double less = 0.7;        // of its depth is left to a front node at bad corners,
constexpr double leastDepth = 0.05; // of h; and of less than this nothing
constexpr double steepest = 0.5;    // h an edge, that the ways which neighbours go differ by
const double pi = std::acos(-1.0);

// Of the front at each vertex into the core, unit; none where its faces are opposed.
std::vector<Vec3> inwards(const Front& front) {
    std::vector<Vec3> faces(front.ownerCell.size()), normals(front.front.size());
    parallelFor(faces.size(), [&](Index f) {
        Vec3 first, last, twice;
        int n = 0;
        for (auto v : front.mesh.fv_range(FrontMesh::FaceHandle(static_cast<int>(f)))) {
            const Vec3& p = front.front[Index(v.idx())];
            if (n++ == 0) first = p;
            else twice += cross(last - first, p - first);
            last = p;
        }
        faces[f] = twice;
    });
    parallelFor(normals.size(), [&](Index v) {
        Vec3 sum;
        for (auto f : front.mesh.vf_range(FrontMesh::VertexHandle(static_cast<int>(v)))) sum += faces[Index(f.idx())];
        normals[v] = normalized(withinSides(sum * -1.0, front.outside[v]));
    });
    return normals;
}

// m, along a way into the domain up to its nearest side that it is not in
double wayToSide(const Box& domain, const Vec3& from, const Vec3& way) {
    double least = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
        const double to = way[axis] > 0 ? domain.hi[axis] : domain.lo[axis];
        if (std::abs(way[axis]) > 1e-6) least = std::min(least, (to - from[axis]) / way[axis]);
    }
    return least;
}

// In edges h (m) of the cell at a place on the wall: of the part there.
double wantedAt(const RoomOfWalls& room, const SurfaceIndex& index, const Vec3& wall, double h) {
    if (room.ofPart.empty()) return room.most.inCells(h);
    const ClosestPoint c = index.closest(wall, h);
    return c ? room.ofPart[Index(index.surface().partOf[Index(c.triangle)])].inCells(h) : 0;
}

// m, by which the front should go inwards at each vertex
std::vector<double> depthsWanted(const Front& front, const std::vector<Vec3>& normals, const SurfaceIndex& index, const Box& domain, const RoomOfWalls& room) {
    std::vector<double> depths(front.front.size(), 0.0);
    parallelFor(depths.size(), [&](Index v) {
        const double h = front.h[v], have = norm(front.front[v] - front.wall(v));
        if (room.most.inCells(h) < usual || normals[v] == Vec3{}) return;
        const double wanted = std::min(wantedAt(room, index, front.wall(v), h), most) * h;
        if (wanted < usual * h || !(wanted > have)) return;
        const Vec3& from = front.front[v];
        const double reach = wanted / ofPassage;
        double may = wanted;
        if (const SegmentHit hit = index.firstHit(from, from + normals[v] * reach)) may = std::min(may, ofPassage * (have + hit.t * reach));
        may = std::min(may, ofDomain * (have + wayToSide(domain, from, normals[v])));
        depths[v] = std::max(0.0, may - have);
    });
    return depths;
}

// How the nodes of a band go for depths of its front.
class Deepening {
  public:
    // Keeps references. from: of all nodes; normals, depths: per wall node.
    Deepening(const Band& band, const Positions& from, int rings, const std::vector<Vec3>& normals, const std::vector<double>& depths)
        : band_(band), from_(from), rings_(rings), normal_(band.fronts), depth_(filled(band.fronts, 0.0)), move_(band.nodes()) {
        parallelFor(band.fronts, [&](Index i) {
            if (band.fansOf[i].size() != 1) return; // cells on both sides of it
            const auto v = Index(band.fansOf[i].front());
            normal_[i] = normals[v], depth_[i] = depths[v];
        });
        findLeaders();
    }
    // Places for all nodes by the depths as they are.
    Positions places() {
        boundSlopes();
        smooth();
        parallelFor(band_.nodes(), [&](Index n) { move_[n] = {}; }, 4096);
        moveFront();
        moveCore();
        Positions to;
        copyTo(to, from_);
        parallelFor(band_.movable - band_.walls, [&](Index k) { to[band_.walls + k] = band_.start[band_.walls + k] + move_[band_.walls + k]; }, 4096);
        return to;
    }
    // Lowers the depths of front nodes where corners would be bad. Gives whether there are any.
    bool goLess(const Positions& places) {
        std::vector<std::uint8_t> bad(band_.fronts, 0);
        parallelFor(band_.corners.items(), [&](Index i) {
            const double limit = i < band_.corners.cells.size() ? badCore : badPrism;
            band_.corners.ofItem(i, [&](const Corner& c) {
                if (!isBad(c, places, from_, limit)) return;
                for (const std::int32_t n : c.node)
                    if (leader_[Index(n)] >= 0) setFlag(bad[Index(leader_[Index(n)])]);
            });
        }, 256);
        std::uint8_t any = 0;
        forFlagged(bad, [&](Index i) {
            if (depth_[i] == 0) return;
            depth_[i] *= less;
            if (depth_[i] < leastDepth * band_.h[band_.walls + i]) depth_[i] = 0;
            setFlag(any);
        });
        return any != 0;
    }

  private:
    const Vec3& at(Index front) const { return from_[band_.walls + front]; }
    // f(other) for the front nodes around one.
    template <class F>
    void around(Index front, const F& f) const {
        for (const BandEdge& e : band_.edges[band_.walls + front]) {
            const auto n = Index(e.b);
            if (n >= band_.walls && n < band_.walls + band_.fronts) f(n - band_.walls);
        }
    }
    // Each node's is the first front node that reaches it, ring by ring.
    void findLeaders() {
        const auto walls = static_cast<std::int32_t>(band_.walls), fronts = static_cast<std::int32_t>(band_.fronts);
        leader_.resize(band_.nodes());
        parallelFor(band_.nodes(), [&](Index n) {
            const auto i = static_cast<std::int32_t>(n);
            leader_[n] = i < walls ? band_.frontNode[n] - walls : i < walls + fronts ? i - walls : -1;
        }, 4096);
        RawVector<std::int32_t> old;
        for (int r = 0; r < 2 * rings_; ++r) {
            copyTo(old, leader_);
            parallelFor(band_.movable, [&](Index n) {
                if (old[n] >= 0) return;
                for (const BandEdge& e : band_.edges[n]) {
                    if (old[Index(e.b)] < 0) continue;
                    leader_[n] = old[Index(e.b)];
                    return;
                }
            });
        }
    }
    void boundSlopes() {
        RawVector<double> old;
        for (int r = 0; r < 2 * rings_; ++r) {
            copyTo(old, depth_);
            parallelFor(band_.fronts, [&](Index i) {
                around(i, [&](Index j) { depth_[i] = std::min(depth_[i], old[j] + slope * norm(at(i) - at(j))); });
            });
        }
    }
    void smooth() {
        RawVector<double> old;
        for (int r = 0; r < smoothings; ++r) {
            copyTo(old, depth_);
            parallelFor(band_.fronts, [&](Index i) {
                double sum = 2 * old[i], weight = 2;
                around(i, [&](Index j) { sum += old[j], ++weight; });
                depth_[i] = sum / weight;
            });
        }
    }
    // Each front node goes by its depth along its normal, and across it with those around.
    void moveFront() {
        Positions moves = filled(band_.fronts, Vec3{}), old;
        for (int r = 0; r < 2 * rings_; ++r) {
            copyTo(old, moves);
            parallelFor(band_.fronts, [&](Index i) {
                if (normal_[i] == Vec3{}) return;
                Vec3 sum;
                double weight = 0;
                around(i, [&](Index j) { sum += old[j], ++weight; });
                const Vec3 mean = weight > 0 ? sum / weight : sum, move = mean + normal_[i] * (depth_[i] - dot(mean, normal_[i]));
                moves[i] = withinSides(move, band_.outside[band_.walls + i]);
            });
        }
        parallelFor(band_.fronts, [&](Index i) { move_[band_.walls + i] = moves[i]; }, 4096);
    }
    // The core behind goes with it, ever less: the ways of all nodes from where the lattice has them are harmonic. Chebyshev's
    // semi-iteration of Jacobi's sweeps (Golub and Varga 1961), by the spectral radius of a chain of as many nodes as there are rings.
    void moveCore() {
        const Index core = band_.walls + band_.fronts;
        parallelFor(band_.nodes() - band_.walls, [&](Index k) { move_[band_.walls + k] += from_[band_.walls + k] - band_.start[band_.walls + k]; }, 4096);
        const double radius = std::cos(pi / (2 * (rings_ + 1.0)));
        double omega = 1;
        Positions before, now;
        copyTo(before, move_), copyTo(now, move_);
        for (int r = 0; r < 2 * rings_; ++r) {
            omega = r == 0 ? 1 : 1 / (1 - (r == 1 ? 0.5 : 0.25 * omega) * radius * radius);
            parallelFor(band_.movable - core, [&](Index k) {
                const Index n = core + k;
                Vec3 sum;
                double weight = 0;
                for (const BandEdge& e : band_.edges[n]) sum += move_[Index(e.b)] * double(e.weight), weight += double(e.weight);
                if (weight > 0) now[n] = withinSides(before[n] + (sum / weight - before[n]) * omega, band_.outside[n]);
            });
            before.swap(move_), move_.swap(now); // now: of two sweeps ago, and overwritten
        }
        settleHanging(band_, core, move_); // of the lattice's places it is true, so of the ways from them
    }

    const Band& band_;
    const Positions& from_;
    int rings_;
    std::vector<Vec3> normal_;       // per front node
    RawVector<double> depth_;        // the same, m
    Positions move_;                 // m, per node: first from `from`, then from the lattice
    RawVector<std::int32_t> leader_; // the same: front node, less walls; or -1
};

} // namespace

bool deepen(Front& front, const LatticeMesh& mesh, const SurfaceIndex& index, const RoomOfWalls& room) {
    if (!wantsDepth(room)) return false;
    const std::vector<Vec3> normals = inwards(front);
    const std::vector<double> depths = depthsWanted(front, normals, index, mesh.lattice().domain(), room);
    const double deepest = orderedReduce(depths.size(), 0.0, [&](Index begin, Index end) { // in h
        double part = 0;
        for (Index v = begin; v < end; ++v) part = std::max(part, depths[v] / front.h[v]);
        return part;
    }, [](double a, double b) { return std::max(a, b); });
    if (deepest == 0) return false;
    const int rings = std::clamp(static_cast<int>(std::ceil(deepest / squeeze)), leastRings, mostRings);
    const Band band = buildBand(mesh, front, rings, room.most);
    Positions from, x;
    takeStored(band, front, from);
    Deepening deepening(band, from, rings, normals, depths);
    Positions to = deepening.places();
    for (int round = 1; round < rounds && deepening.goLess(to); ++round) to = deepening.places();
    BlendOptions options;
    options.slope = std::min(options.slope, steepest / deepest), options.maybePoor = true;
    blend(band, from, to, x, options);
    store(band, x, front);
    return true;
}

} // namespace i2b
