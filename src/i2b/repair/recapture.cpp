#include "i2b/repair/recapture.h"
#include "i2b/core/quantile.h"
#include "i2b/core/sort_unique.h"
#include "i2b/quality/sharp_samples.h"
#include "i2b/repair/moved_parts.h"
#include "i2b/repair/wanted_nodes.h"
#include <algorithm>
#include <set>
#include <unordered_map>

namespace i2b {
namespace {

using Index = std::size_t;
constexpr int rounds = 16;                     // of tries, the first of
constexpr int roundsTogether = 1;              // which are of all nodes at once: of two that miss one edge none may help alone
constexpr int rings = 3;                       // of wall faces around a node whose samples may come or go with it
constexpr double tooNear = 0.2;                 // of h: nodes that go to one edge stay so far apart
constexpr double mayBeOff = 0.01;               // of h: a node nearer to the geometry is on it
constexpr int mendSweeps = 12, tetSweeps = 4;

double sizeOfMost(const Front& front) {
    std::vector<double> sizes(front.h.begin(), front.h.end());
    return sizes.empty() ? 0 : median(sizes);
}

class Recapture {
  public:
    Recapture(const PolyMesh& mesh, const Rows& cellFaces, const MeshFaults& faults, const Front& front, const WallGuide& guide, Optimiser& optimiser)
        : mesh_(mesh), faults_(faults), front_(front), guide_(guide), optimiser_(optimiser), samples_(mesh, cellFaces, *guide.graph, guide.index, sizeOfMost(front)),
          wanted_(mesh, samples_, front, guide, optimiser.nodes()), poor_(poorCells()), undivided_(faults.undividedFaces()) {}

    std::int64_t run() {
        std::int64_t came = 0;
        for (int round = 0; round < rounds; ++round) {
            const std::vector<WantedNode> wanted = round < roundsTogether ? eachOnce(wanted_.find()) : apart(wanted_.find());
            if (wanted.empty()) break;
            came += bring(wanted);
        }
        return came;
    }

  private:
    struct Try {
        std::unordered_map<std::int32_t, Snap> held; // what the nodes that are where they were wanted were held to before
        std::vector<std::uint32_t> samples;          // that may come or go with them,
        std::vector<std::uint8_t> captured;          // and whether they were
    };

    std::vector<std::int32_t> poorCells() const {
        FaultCount count;
        std::vector<std::int32_t> cells = faults_.badCells();
        const std::vector<std::int32_t> poor = faults_.poorCells(count);
        cells.insert(cells.end(), poor.begin(), poor.end());
        sortUnique(cells);
        return cells;
    }
    const Optimiser::Star& starOf(const WantedNode& w) { return optimiser_.starOf({MeshNode::wall, w.vertex}, w.cell); }

    // Each node once, and none to where another is to go already.
    std::vector<WantedNode> eachOnce(const std::vector<WantedNode>& found) {
        std::vector<WantedNode> chosen;
        std::set<std::int32_t> vertices;
        std::unordered_map<std::int32_t, std::vector<Vec3>> places; // where those are to go that move a cell
        for (const WantedNode& w : found) {
            const std::vector<std::int32_t>& cells = starOf(w).cells;
            const double near = tooNear * front_.h[Index(w.vertex)];
            const bool isTaken = std::ranges::any_of(cells, [&](std::int32_t c) {
                const auto at = places.find(c);
                return at != places.end() && std::ranges::any_of(at->second, [&](const Vec3& p) { return norm(p - w.snap.point) < near; });
            });
            if (isTaken || !vertices.insert(w.vertex).second) continue;
            for (const std::int32_t c : cells) places[c].push_back(w.snap.point);
            chosen.push_back(w);
        }
        return chosen;
    }

    // Of these such as do not get in each other's way: none moves what another is judged by. They count as tried.
    std::vector<WantedNode> apart(const std::vector<WantedNode>& found) {
        std::vector<WantedNode> chosen;
        std::set<std::int32_t> cells;
        for (const WantedNode& w : found) {
            const Optimiser::Star& star = starOf(w);
            if (std::ranges::any_of(star.reads, [&](std::int32_t c) { return cells.contains(c); })) continue;
            cells.insert(star.reads.begin(), star.reads.end());
            chosen.push_back(w);
            wanted_.markTried(w);
        }
        return chosen;
    }

    // Puts nodes where they are wanted and mends the cells around them.
    void put(const std::vector<WantedNode>& wanted) {
        std::vector<Optimiser::NodeMove> moves;
        std::vector<std::int32_t> cells;
        for (const WantedNode& w : wanted) {
            moves.push_back({{MeshNode::wall, w.vertex}, w.cell, w.snap.point});
            guide_.snaps[Index(w.vertex)] = w.snap;
            const Optimiser::Star& star = starOf(w);
            cells.insert(cells.end(), star.reads.begin(), star.reads.end());
        }
        sortUnique(cells);
        optimiser_.moveTogether(moves);
        optimiser_.mendAt(cells, mendSweeps);
    }

    // Cells with a fault that was not there before.
    std::vector<std::int32_t> newlyPoor() const {
        std::vector<std::int32_t> cells;
        std::ranges::set_difference(poorCells(), poor_, std::back_inserter(cells));
        return cells;
    }

    // The part that has moved the wall at or near a sample; -1: none.
    std::int32_t partAt(const MovedParts& parts, std::uint32_t sample) const {
        std::int32_t part = -1;
        for (int ring = 0; ring < rings && part < 0; ++ring)
            for (const std::int32_t f : samples_.grown({samples_.samples()[sample].at.face}, ring))
                MovedParts::forPartsOf(parts.changed, mesh_.owner[Index(samples_.meshFace(f))], [&](std::int32_t p) { part = part < 0 ? p : part; });
        return part;
    }

    // Has a node that has moved not left the geometry for it?
    bool staysOn(const MeshNode& node) const {
        if (node.kind != MeshNode::wall) return true;
        const double off = mayBeOff * front_.h[Index(node.id)];
        const double before = std::max(off, guide_.index.closest(optimiser_.tracked().at(node).to).distance);
        return bool(guide_.index.closest(front_.wall(Index(node.id)), before * (1 + 1e-9)));
    }

    // Per part whether it is to stay: it has made no cell poor. At last also: it captures more of the samples than before, has taken no node off
    // the geometry and no face that it has changed fails to divide; one that did before would be left to the last resort, which might not help as
    // it is now. (A part that captures no more may come together with one that does when faces are made to divide.)
    std::vector<std::uint8_t> areGood(const MovedParts& parts, const Try& now, bool isLast) {
        std::vector<std::uint8_t> good(parts.nodes.size(), 1);
        const auto spoil = [&](const MovedParts::Cells& cells, const std::vector<std::int32_t>& faulty) {
            for (const std::int32_t c : faulty) MovedParts::forPartsOf(cells, c, [&](std::int32_t p) { good[Index(p)] = 0; });
        };
        spoil(parts.read, newlyPoor());
        if (!isLast) return good;
        spoil(parts.changed, cellsBeside(mesh_, faults_.undividedFaces()));
        for (Index n = 0; n < parts.nodes.size(); ++n)
            if (!staysOn(parts.nodes[n])) good[Index(parts.partOf[n])] = 0;
        const std::vector<std::int64_t> gain = gainsOf(parts, now);
        for (Index p = 0; p < good.size(); ++p)
            if (gain[p] <= 0) good[p] = 0;
        return good;
    }

    // Per part how many samples more than before are captured.
    std::vector<std::int64_t> gainsOf(const MovedParts& parts, const Try& now) {
        const std::vector<std::uint32_t>& samples = now.samples;
        std::vector<std::int64_t> gain(parts.nodes.size(), 0);
        samples_.judge(samples);
        for (Index i = 0; i < samples.size(); ++i) {
            const int more = int(samples_.isCaptured(samples[i])) - int(now.captured[i]);
            const std::int32_t part = more != 0 ? partAt(parts, samples[i]) : -1;
            if (part >= 0) gain[Index(part)] += more;
        }
        return gain;
    }

    static std::vector<MeshNode> nodesOf(const std::map<MeshNode, Optimiser::NodeMove>& tracked) {
        std::vector<MeshNode> nodes;
        for (const auto& [node, from] : tracked) nodes.push_back(node);
        return nodes;
    }

    void goBack(Try& now, const std::vector<MeshNode>& nodes) {
        optimiser_.moveBack(nodes);
        for (const MeshNode& node : nodes) {
            const auto was = node.kind == MeshNode::wall ? now.held.find(node.id) : now.held.end();
            if (was == now.held.end()) continue;
            guide_.snaps[Index(node.id)] = was->second;
            now.held.erase(was);
        }
    }

    // The parts that are not to stay go back.
    void keepGood(Try& now, bool isLast) {
        const MovedParts parts(optimiser_);
        const std::vector<std::uint8_t> good = areGood(parts, now, isLast);
        std::vector<MeshNode> back;
        for (Index n = 0; n < parts.nodes.size(); ++n)
            if (!good[Index(parts.partOf[n])]) back.push_back(parts.nodes[n]);
        goBack(now, back);
    }

    // Gives how many nodes stay where they were wanted.
    std::int64_t bring(const std::vector<WantedNode>& wanted) {
        Try now;
        SharpSamples::Faces faces;
        for (const WantedNode& w : wanted) faces.push_back(w.face), now.held[w.vertex] = guide_.snaps[Index(w.vertex)];
        now.samples = samples_.at(samples_.grown(std::move(faces), rings));
        for (const std::uint32_t s : now.samples) now.captured.push_back(samples_.isCaptured(s));
        optimiser_.track();
        put(wanted);
        keepGood(now, false);
        optimiser_.mendTets(tetSweeps, undivided_); // which takes longest
        keepGood(now, true);
        if (!newlyPoor().empty()) goBack(now, nodesOf(optimiser_.tracked())); // parts are apart, so that none should be
        optimiser_.keep();
        samples_.judge(now.samples);
        return static_cast<std::int64_t>(now.held.size());
    }

    const PolyMesh& mesh_;
    const MeshFaults& faults_;
    const Front& front_;
    const WallGuide& guide_;
    Optimiser& optimiser_;
    SharpSamples samples_;
    WantedNodes wanted_;
    std::vector<std::int32_t> poor_, undivided_; // cells and faces of before
};

} // namespace

std::int64_t recapture(const PolyMesh& mesh, const Rows& cellFaces, const MeshFaults& faults, const Front& front, const WallGuide& guide, Optimiser& optimiser) {
    return Recapture(mesh, cellFaces, faults, front, guide, optimiser).run();
}

} // namespace i2b
