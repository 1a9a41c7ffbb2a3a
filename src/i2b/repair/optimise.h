// Moves the nodes of poor cells, one at a time, so that what checkMesh measures of the cells around gets better: each
// move lowers the sum of what is near or over the limits and never raises the worst of it. Wall nodes glide on the
// geometry, snapped ones on their line. Nodes whose cells have no face in common move at once, colour by colour; the
// result does not depend on the number of threads.
#pragma once
#include "i2b/fit/fit.h"
#include "i2b/quality/mesh_faults.h"
#include "i2b/repair/mesh_nodes.h"
#include "i2b/repair/resting_nodes.h"
#include <map>
#include <optional>
#include <unordered_map>
#include <unordered_set>

namespace i2b {

struct Badness;

// The cells at both sides of faces, ascending.
std::vector<std::int32_t> cellsBeside(const PolyMesh& mesh, const std::vector<std::int32_t>& faces);

// What the wall nodes belong to.
struct WallGuide {
    const SurfaceIndex& index;
    const FeatureIndex& features;
    std::vector<Snap>& snaps;        // per vertex of the front; those that the fit put in may be missing
    const std::vector<Snap>& wishes; // the same: features that others should be brought to, if that can be; or none
    const FeatureGraph* graph = nullptr; // whose sharp edges the wall is to have; none: it stays as it is
};

class Optimiser {
  public:
    // Keeps references. faults: as the mesh is now; kept up to date.
    Optimiser(PolyMesh& mesh, const Rows& cellFaces, MeshFaults& faults, Front& front, LayerStack& layers, const WallGuide& guide);

    // The nodes of poor and wrong cells, until nothing gets better. Gives how many moves were made. mayLeave: wall nodes
    // need not stay on the geometry.
    std::int64_t mend(int sweeps, bool mayLeave = false);
    // The same, where no face that divides into tetrahedra may cease to; where one beside it does not already, all together may not lack more.
    std::int64_t mendKeepingTets(int sweeps);
    // The same of those among these cells (ascending).
    void mendAt(const std::vector<std::int32_t>& cells, int sweeps);
    // The nodes of these thin cells, whose determinants count then, which a limit for all cells has them keep to.
    void mendFlatAt(const std::vector<std::int32_t>& cells, int sweeps);
    // The nodes of faces that do not divide into tetrahedra or turn back at a corner, then all of the cells beside them, within all
    // other limits. but: faces that stay as they are, ascending.
    void mendTets(int sweeps, const std::vector<std::int32_t>& but = {});
    // The same of the cells beside these faces only, where theirs at the wall may leave the geometry by up to a fifth of a cell. They come
    // back as far as that undoes nothing.
    void mendTetsOffWall(std::vector<std::int32_t> faces, int sweeps);
    // Moves nodes wherever they are to go, all at once.
    struct NodeMove {
        MeshNode node;
        std::int32_t cell = -1; // one that uses a point of the node
        Vec3 to;                // m
        float bend = -1;        // of a wall node's column; less than 0: stays as it is
    };
    void moveTogether(const std::vector<NodeMove>& moves);
    // Remembers from here on which nodes move, until they stay where they are or go back to where they were. comeBack() brings those of
    // the wall as far back as that undoes nothing, but for those of the cells beside some faces.
    void track() { tracked_.emplace(); }
    void comeBack(int sweeps, const std::vector<std::int32_t>& butAt = {});
    std::vector<NodeMove> trackedPlaces() const; // where those are that have moved
    const std::map<MeshNode, NodeMove>& tracked() const { return *tracked_; } // where they were; only since track()
    void moveBack(const std::vector<MeshNode>& nodes); // of the tracked ones, which are forgotten
    void keep() { tracked_.reset(); }
    void undo();
    const MeshNodes& nodes() const { return nodes_; }
    struct Star {
        std::vector<std::int32_t> cells;    // all that use a point of the node, ascending
        std::vector<std::int32_t> reads;    // these and those beyond their faces: what a move is judged by
    };
    const Star& starOf(const MeshNode& node, std::int32_t cell); // a cell that uses a point of the node
    // Columns of poor and wrong cells more or less bent.
    std::int64_t bend();
    // Nodes to the features that they should be on; those that get there are held to them.
    std::int64_t snapWished(int sweeps);
    // Wall nodes off the geometry, the whole, half or a quarter of their way, as far as no limit is broken.
    std::int64_t pullIn(int sweeps);

  private:
    struct Task {
        MeshNode node;
        std::int32_t cell = -1;             // one that uses a point of the node
        const Star* star = nullptr;
    };
    struct Worker;
    std::vector<Task> tasksOf(const std::vector<std::int32_t>& cells) const;
    std::vector<Task> tasksOfFaces(const std::vector<std::int32_t>& faces) const;
    void addNodes(std::int32_t face, std::int32_t cell, std::vector<std::pair<MeshNode, std::int32_t>>& found) const;
    static std::vector<Task> asTasks(std::vector<std::pair<MeshNode, std::int32_t>> found);
    std::vector<Task> tasksOff() const;
    std::vector<std::vector<std::uint32_t>> colour(const std::vector<Task>& tasks) const;
    std::vector<Task> tasksOfCellsAt(const std::vector<std::int32_t>& faces) const;
    template <class Move>
    std::int64_t sweep(std::vector<Task>& tasks, const Move& move, RestingNodes* resting = nullptr); // asks none of those, and notes further ones
    void findStar(const Task& task, Worker& worker, Star& star) const;
    bool isFree(const MeshNode& node, const Vec3& to) const;
    bool keepsFolds(const MeshNode& node, const Vec3& to) const;
    bool isHeld(const MeshNode& wall) const;
    bool mayLeave(const MeshNode& wall) const { return allLeave_ || leavers_.contains(wall.id); }
    void allMayLeave(bool may) { allLeave_ = may, leavers_.clear(); }
    enum class Hold : std::uint8_t { nothing, surface, feature };
    Hold holdAt(const MeshNode& node, const Vec3& from) const;
    Vec3 onWall(Hold hold, const MeshNode& node, const Vec3& from, const Vec3& to) const;
    bool targetOf(std::int32_t vertex, Vec3& target) const;
    bool bendNode(const Task& task, Worker& worker);
    bool mendNode(const Task& task, Worker& worker);
    bool mendNodeTets(const Task& task, Worker& worker);
    double sizeAt(std::int32_t vertex) const;
    Vec3 wayToOpen(std::int32_t vertex) const;
    using Places = std::unordered_map<std::int32_t, Vec3>; // of wall vertices, m
    void bringBack(std::vector<Task> tasks, const Places& places, int sweeps);
    bool bringBack(const Task& task, const Vec3& to, Worker& worker);
    float* bendOf(const MeshNode& wall) const;
    NodeMove whereIs(const MeshNode& node, std::int32_t cell) const;
    bool bendForTets(const Task& task, Worker& worker, const Vec3& at, double& least);
    bool fitsAt(const Task& task, Worker& worker, const Vec3& to, const Badness& before);
    bool comeTo(const Task& task, Worker& worker, const Vec3& to, const Badness& before, double shortest);
    bool pullNode(const Task& task, Worker& worker);
    bool snapNode(const Task& task, Worker& worker);
    std::vector<Task> wallTasks(const std::vector<std::uint8_t>& wanted) const;

    PolyMesh& mesh_;
    const Rows& cellFaces_;
    MeshFaults& faults_;
    Front& front_;
    LayerStack& stack_;
    std::unordered_set<std::int32_t> leavers_; // wall vertices that need not stay on the geometry;
    bool allLeave_ = false;                    // nor need any other
    bool keepsTets_ = false;                   // do moves for other limits leave faces that divide as they are?
    bool isLast_ = false;                      // are few faces left, which are worth any effort?
    bool thin_;           // are the layers thin?
    int layers_;          // cells of the highest stack of thin layers, which share their faults; 1 where there are none
    WallGuide guide_;
    MeshNodes nodes_;
    std::map<MeshNode, Star> stars_; // of those asked so far: points move, cells stay
    std::optional<std::map<MeshNode, NodeMove>> tracked_; // where they were
    double leastFull_ = 0; // CellStar::countFlat()
};

} // namespace i2b
