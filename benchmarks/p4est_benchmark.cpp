// The peer of the grid stages: p4est (p8est) on the bricks that are our base cells, refined where our own triangle/box
// test says that a triangle meets the octant, then balanced 2:1 over faces, edges and corners. Every octant sees only the
// triangles that its parent met, so the peer pays for no search. Ours is timed in the same run, before it, on rank 0 with
// as many threads as there are ranks, with the least buffer. One line of JSON for each size.
//
//     mpirun -np 2 p4est_benchmark [--case motorBike|engine] [--sizes 4,2,1]     (mm)
#include "grid_cases.h"
#include "i2b/geometry/triangle_box.h"
#include "i2b/grid/build.h"
#include "i2b/grid/cut.h"
#include <chrono>
#include <cstdio>
#include <cstring>
#include <p8est_bits.h>
#include <p8est_extended.h>
#include <sstream>
#include <tbb/global_control.h>
#include <thread>

namespace {

using namespace i2b;
using Clock = std::chrono::steady_clock;

double since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

// The triangles of an octant and of all its ancestors: refinement goes depth first, so a stack is enough.
class Candidates {
  public:
    Candidates(const Surface& surface, const SizeField& field) : field_(field) {
        const Vec3 s = field.lattice.base;
        for (const auto& t : surface.triangles) {
            std::array<Vec3, 3> v;
            for (std::size_t i = 0; i < 3; ++i) {
                const Vec3 d = surface.points[t[i]] - field.lattice.origin;
                v[i] = {d.x / s.x, d.y / s.y, d.z / s.z};
            }
            tests_.emplace_back(v[0], v[1], v[2]);
        }
        byBrick_.resize(static_cast<std::size_t>(field.lattice.count[0]) * static_cast<std::size_t>(field.lattice.count[1]) *
                        static_cast<std::size_t>(field.lattice.count[2]));
        const Index3 n = field.lattice.count;
        for (std::size_t t = 0; t < tests_.size(); ++t) {
            const Box& box = tests_[t].bounds();
            Index3 lo{}, hi{};
            for (std::size_t i = 0; i < 3; ++i) {
                const int a = static_cast<int>(i);
                lo[i] = std::clamp(static_cast<std::int32_t>(std::ceil(box.lo[a])) - 1, 0, n[i] - 1);
                hi[i] = std::clamp(static_cast<std::int32_t>(std::floor(box.hi[a])), 0, n[i] - 1);
            }
            for (std::int32_t z = lo[2]; z <= hi[2]; ++z)
                for (std::int32_t y = lo[1]; y <= hi[1]; ++y)
                    for (std::int32_t x = lo[0]; x <= hi[0]; ++x) byBrick_[brick(x, y, z)].push_back(static_cast<std::uint32_t>(t));
        }
    }

    std::size_t brick(std::int32_t x, std::int32_t y, std::int32_t z) const {
        return static_cast<std::size_t>((z * field_.lattice.count[1] + y) * field_.lattice.count[0] + x);
    }

    // How many triangles meet the octant of the tree at (x, y, z) base cells.
    std::size_t meet(const Index3& tree, const p8est_quadrant_t& q) {
        const auto level = static_cast<std::size_t>(q.level);
        if (tree != tree_) tree_ = tree, depth_ = 0;
        // Ancestors that are still those of the octant that was asked for last.
        std::size_t known = std::min(depth_, level + 1);
        while (known > 0 && !holds(stack_[known - 1].octant, q)) --known;
        for (std::size_t l = known; l <= level; ++l) filter(l, q);
        depth_ = level + 1;
        return stack_[level].triangles.size();
    }

  private:
    struct Level {
        p8est_quadrant_t octant{};
        std::vector<std::uint32_t> triangles;
    };
    static bool holds(const p8est_quadrant_t& a, const p8est_quadrant_t& q) {
        return p8est_quadrant_is_equal(&a, &q) || p8est_quadrant_is_ancestor(&a, &q);
    }
    void filter(std::size_t l, const p8est_quadrant_t& q) {
        if (stack_.size() <= l) stack_.resize(l + 1);
        Level& level = stack_[l];
        if (static_cast<int>(l) == q.level) level.octant = q;
        else p8est_quadrant_ancestor(&q, static_cast<int>(l), &level.octant);
        const double scale = 1.0 / P8EST_ROOT_LEN, h = P8EST_QUADRANT_LEN(l) * scale;
        const Vec3 lo{tree_[0] + level.octant.x * scale, tree_[1] + level.octant.y * scale, tree_[2] + level.octant.z * scale};
        const Vec3 hi = lo + Vec3{h, h, h};
        level.triangles.clear();
        for (std::uint32_t t : l == 0 ? byBrick_[brick(tree_[0], tree_[1], tree_[2])] : stack_[l - 1].triangles) {
            if (tests_[t].meets(lo, hi)) level.triangles.push_back(t);
        }
    }

    const SizeField& field_;
    std::vector<TriangleBoxTest> tests_; // in base cells
    std::vector<std::vector<std::uint32_t>> byBrick_;
    Index3 tree_{-1, -1, -1};
    std::size_t depth_ = 0;
    std::vector<Level> stack_;
};

struct Peer {
    Candidates* candidates;
    std::vector<Index3> place; // of each tree, in base cells
    int until = 0;             // octants below this level are refined where cut
};
Peer& peerOf(p8est_t* forest) { return *static_cast<Peer*>(forest->user_pointer); }

int refineCut(p8est_t* forest, p4est_topidx_t tree, p8est_quadrant_t* q) {
    Peer& peer = peerOf(forest);
    return q->level < peer.until && peer.candidates->meet(peer.place[static_cast<std::size_t>(tree)], *q) > 0;
}
int weighCut(p8est_t* forest, p4est_topidx_t tree, p8est_quadrant_t* q) {
    Peer& peer = peerOf(forest);
    const bool cut = q->level == peer.until && peer.candidates->meet(peer.place[static_cast<std::size_t>(tree)], *q) > 0;
    return cut ? 1000 : 1;
}

struct Figures {
    double cells = 0, seconds = 0, refine = 0, balance = 0;
};

Figures runPeer(const Surface& surface, const SizeField& field) {
    const Index3 n = field.lattice.count;
    p8est_connectivity_t* bricks = p8est_connectivity_new_brick(n[0], n[1], n[2], 0, 0, 0);
    Candidates candidates(surface, field);
    Peer peer{&candidates, {}, 0};
    for (p4est_topidx_t t = 0; t < bricks->num_trees; ++t) {
        const double* low = bricks->vertices + 3 * bricks->tree_to_vertex[8 * t];
        peer.place.push_back({static_cast<std::int32_t>(low[0]), static_cast<std::int32_t>(low[1]), static_cast<std::int32_t>(low[2])});
    }
    const int finest = field.partLevel[0].x;
    MPI_Barrier(MPI_COMM_WORLD);
    const auto start = Clock::now();
    p8est_t* forest = p8est_new_ext(MPI_COMM_WORLD, bricks, 0, 0, 1, 0, nullptr, &peer);
    peer.until = std::max(1, finest - 4); // then even out what the ranks have to do
    p8est_refine_ext(forest, 1, -1, refineCut, nullptr, nullptr);
    p8est_partition_ext(forest, 0, weighCut);
    peer.until = finest;
    p8est_refine_ext(forest, 1, -1, refineCut, nullptr, nullptr);
    MPI_Barrier(MPI_COMM_WORLD);
    Figures f;
    f.refine = since(start);
    p8est_balance_ext(forest, P8EST_CONNECT_FULL, nullptr, nullptr);
    MPI_Barrier(MPI_COMM_WORLD);
    f.seconds = since(start);
    f.balance = f.seconds - f.refine;
    f.cells = static_cast<double>(forest->global_num_quadrants);
    p8est_destroy(forest);
    p8est_connectivity_destroy(bricks);
    return f;
}

Figures runOurs(const Surface& surface, const SizeField& field, int threads) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    Figures best;
    for (int repeat = 0; repeat < 3; ++repeat) {
        const auto start = Clock::now();
        const std::vector<CellLevel> atTarget = cutAtTargetLevels(surface, field);
        const CellGrid grid = buildCellGrid(field, wantedCells(field, atTarget));
        const double seconds = since(start);
        if (repeat == 0 || seconds < best.seconds) best = {static_cast<double>(grid.cellCount()), seconds, 0, 0};
    }
    return best;
}

// A barrier that leaves the cores alone: MPI's own waits in a busy loop, at the cost of who is still at work.
void sleepUntilAll() {
    MPI_Request request;
    MPI_Ibarrier(MPI_COMM_WORLD, &request);
    for (int done = 0; MPI_Test(&request, &done, MPI_STATUS_IGNORE), !done;) std::this_thread::sleep_for(std::chrono::milliseconds(2));
}

} // namespace

int main(int argc, char** argv) {
    MPI_Init(&argc, &argv);
    int rank = 0, ranks = 1;
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, &ranks);
    sc_init(MPI_COMM_WORLD, 0, 0, nullptr, SC_LP_ERROR);
    p4est_init(nullptr, SC_LP_ERROR);
    std::string name = "motorBike", sizes = "4,2,1", one;
    for (int i = 1; i + 1 < argc; i += 2) (std::strcmp(argv[i], "--case") == 0 ? name : sizes) = argv[i + 1];
    const Surface& surface = benchmarks::surfaceOf(name);
    std::stringstream list(sizes);
    while (!surface.triangles.empty() && std::getline(list, one, ',')) {
        const SizeField field = benchmarks::fieldOf(name, std::stod(one), 1);
        Figures ours;
        if (rank == 0) ours = runOurs(surface, field, ranks);
        sleepUntilAll();
        const Figures peer = runPeer(surface, field);
        if (rank != 0) continue;
        std::printf("{\"case\": \"%s\", \"millimetres\": %s, \"ranks\": %d, \"cells\": %.0f, \"seconds\": %.4f, \"cells_per_second\": %.0f, "
                    "\"p4est_octants\": %.0f, \"p4est_seconds\": %.4f, \"p4est_refine\": %.4f, \"p4est_balance\": %.4f, "
                    "\"p4est_octants_per_second\": %.0f}\n",
                    name.c_str(), one.c_str(), ranks, ours.cells, ours.seconds, ours.cells / ours.seconds, peer.cells, peer.seconds, peer.refine,
                    peer.balance, peer.cells / peer.seconds);
        std::fflush(stdout);
    }
    if (surface.triangles.empty() && rank == 0) std::fprintf(stderr, "motorBike.obj.gz is neither in $I2B_GEOMETRY_DIR nor in /usr/share/doc/openfoam-examples\n");
    sc_finalize();
    MPI_Finalize();
}
