#include "i2b/repair/step_back.h"
#include "i2b/edit/last_resort.h"
#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <set>

namespace i2b {
namespace {

using Index = std::size_t;
constexpr std::array<double, 8> shares{0.08, 0.15, 0.22, 0.3, 0.4, 0.5, 0.75, 1}; // of the way to the start
constexpr std::array<int, 4> ringsTried{3, 5, 2, 4};             // of cells that come along;
constexpr std::size_t mostRings = 2, few = 32;                   // of more than a few faces only so many of these
constexpr int looks = 7;                                         // that are looked at
constexpr int most = 64;                                         // faces
constexpr std::size_t mostMore = 16;                             // that the way back may add, for single moves to mend
constexpr std::size_t crowded = 40;                              // faults so many around a face are not for this
constexpr int patience = 5;                                      // places in turn where nothing helps
constexpr int mendSweeps = 6, tetSweeps = 8, backSweeps = 3;

// What a face is amid.
struct Around {
    std::vector<std::int32_t> cells, faces; // all that are looked at, ascending
    std::vector<std::int32_t> near;         // cells whose nodes go back
    std::map<MeshNode, std::pair<double, std::int32_t>> nodes; // how much of the way each goes; a cell that uses it
};

class StepBack {
  public:
    StepBack(const StepBackInput& in, Optimiser& optimiser) : in_(in), optimiser_(optimiser), poorBefore_(poor()) {}

    enum class Outcome { nothingToDo, mended, failed, crowded };
    // Mended where there is one face less that nothing helps.
    Outcome mend(const Around& around) {
        if (isCrowded(around)) return Outcome::crowded;
        const std::vector<std::int32_t> before = beyondHelp(around);
        if (before.empty()) return Outcome::nothingToDo; // what was done for another has done it
        const auto isLess = [&](const Left& left) { return left && left->size() < before.size(); };
        for (const double share : shares) {
            optimiser_.track();
            optimiser_.moveTogether(movesOf(around, share));
            if (isLess(mended(around, before.size()))) {
                comeBack(around, before.size());
                optimiser_.keep();
                return Outcome::mended;
            }
            optimiser_.undo();
        }
        return Outcome::failed;
    }

    Around aroundAt(std::int32_t face, int rings) const {
        Around around;
        std::vector<std::int32_t> cells{in_.mesh.owner[Index(face)]};
        if (face < in_.mesh.internalFaces()) cells.push_back(in_.mesh.neighbour[Index(face)]);
        std::set<std::int32_t> seen(cells.begin(), cells.end());
        std::vector<MeshNode> nodes;
        for (int ring = 0; ring < looks; ++ring) {
            std::vector<std::int32_t> next;
            for (const std::int32_t c : cells) {
                for (const std::int32_t f : in_.cellFaces[c]) {
                    around.faces.push_back(f);
                    nodes.clear();
                    for (const std::int32_t p : in_.mesh.face(f))
                        if (ring < rings) optimiser_.nodes().nodesOf(p, nodes);
                    for (const MeshNode& n : nodes) around.nodes.try_emplace(n, 1 - double(ring) / rings, c); // nearer rings come first
                    if (f >= in_.mesh.internalFaces()) continue;
                    for (const std::int32_t other : {in_.mesh.owner[Index(f)], in_.mesh.neighbour[Index(f)]}) {
                        if (seen.insert(other).second) next.push_back(other);
                    }
                }
            }
            if (ring < rings) around.near.insert(around.near.end(), cells.begin(), cells.end());
            cells = std::move(next);
        }
        around.cells.assign(seen.begin(), seen.end());
        std::sort(around.faces.begin(), around.faces.end());
        around.faces.erase(std::unique(around.faces.begin(), around.faces.end()), around.faces.end());
        return around;
    }

  private:
    bool isCrowded(const Around& around) const { return undivided(around).size() > crowded; }
    Vec3 wallStart(Index vertex) const {
        const Front& front = in_.front;
        if (vertex < front.firstInserted()) {
            const std::array<std::int8_t, 3>& d = front.direction[vertex];
            return in_.lattice.latticePoint(front.corePoint[vertex]) + Vec3{double(d[0]), double(d[1]), double(d[2])} * (in_.startThickness * front.h[vertex]);
        }
        const Front::Inserted& i = front.inserted[vertex - front.firstInserted()];
        const Vec3 a = wallStart(Index(i.ends[0])), b = wallStart(Index(i.ends[1]));
        return a + (b - a) * i.t;
    }
    Vec3 startOf(const MeshNode& node) const {
        if (node.kind == MeshNode::wall) return wallStart(Index(node.id));
        return in_.lattice.latticePoint(node.kind == MeshNode::core ? in_.front.movedPoints[Index(node.id)] : node.id);
    }
    std::vector<Optimiser::NodeMove> movesOf(const Around& around, double share) const {
        std::vector<Optimiser::NodeMove> moves;
        for (const auto& [node, weight] : around.nodes) {
            const Vec3 from = optimiser_.nodes().place(node);
            moves.push_back({node, weight.second, from + (startOf(node) - from) * (share * weight.first)});
        }
        return moves;
    }
    std::int64_t poor() const {
        FaultCount count;
        in_.faults.poorCells(count);
        return count.all;
    }
    std::vector<std::int32_t> undivided(const Around& around) const {
        std::vector<std::int32_t> faces;
        std::ranges::set_intersection(around.faces, in_.faults.undividedFaces(), std::back_inserter(faces));
        return faces;
    }
    std::vector<std::int32_t> beyondHelp(const Around& around) const {
        return facesBeyondHelp(in_.mesh, in_.cellFaces, undivided(around), in_.limits, in_.faults.thinFrom());
    }
    // The faces that nothing helps; none where other faults have come or many of these.
    using Left = std::optional<std::vector<std::int32_t>>;
    Left look(const Around& around) const {
        if (isCrowded(around) || !in_.faults.badCells().empty() || poor() > poorBefore_) return {};
        return beyondHelp(around);
    }
    // Single moves until there are less than that many; what is left then.
    Left mended(const Around& around, std::size_t before) {
        if (isCrowded(around) || poor() > poorBefore_ + std::int64_t(crowded) || in_.faults.badCells().size() > crowded) return {};
        Left left = look(around);
        if (!left) {
            optimiser_.mendAt(around.cells, mendSweeps);
            left = look(around);
        }
        if (!left || left->size() < before || left->size() > before + mostMore) return left;
        optimiser_.mendTetsOffWall(*left, tetSweeps);
        return look(around);
    }

    // As far as less than that many are left: all that have gone, or all but those beside faces that do not divide, or none.
    void comeBack(const Around& around, std::size_t before) {
        const std::vector<Optimiser::NodeMove> places = optimiser_.trackedPlaces();
        const std::vector<std::int32_t> faces = undivided(around);
        for (const bool all : {true, false}) {
            optimiser_.comeBack(backSweeps, all ? std::vector<std::int32_t>{} : faces);
            if (const Left left = look(around); left && left->size() < before) return;
            optimiser_.moveTogether(places);
        }
    }

    const StepBackInput& in_;
    Optimiser& optimiser_;
    std::int64_t poorBefore_ = 0;
};

} // namespace

std::int64_t stepBackFrom(const std::vector<std::int32_t>& faces, const StepBackInput& in, Optimiser& optimiser) {
    using Outcome = StepBack::Outcome;
    StepBack back(in, optimiser);
    std::int64_t mended = 0;
    int failed = 0, tried = 0;
    const Index rings = faces.size() <= few ? ringsTried.size() : mostRings;
    std::set<std::int32_t> hopeless; // cells where it has not helped
    for (Index i = 0; i < faces.size() && tried < most && failed < patience; ++i) {
        if (hopeless.contains(in.mesh.owner[Index(faces[i])])) continue; // the layers of a column have their faults together
        Outcome outcome = Outcome::failed;
        std::vector<std::int32_t> near;
        for (std::size_t k = 0; k < rings && outcome == Outcome::failed; ++k) {
            Around around = back.aroundAt(faces[i], ringsTried[k]);
            outcome = back.mend(around);
            if (k == 0) near = std::move(around.near);
        }
        tried += outcome != Outcome::crowded;
        if (outcome == Outcome::mended) ++mended, failed = 0;
        if (outcome == Outcome::failed) ++failed;
        if (outcome == Outcome::failed || outcome == Outcome::crowded) hopeless.insert(near.begin(), near.end());
    }
    return mended;
}

} // namespace i2b
