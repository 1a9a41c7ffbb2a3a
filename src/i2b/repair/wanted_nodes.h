// Nodes of the wall that should stand on a sharp edge which it has missed, for samples of the edge that are not captured (fit_report.h):
// a node beside a corner at which none stands should be there, a free one on the line beside it, and one that stands on the line farther along
// it, as where the front ends in a wedge too narrow for cells.
#pragma once
#include "i2b/quality/sharp_samples.h"
#include "i2b/repair/optimise.h"
#include <cstdint>
#include <set>
#include <tuple>
#include <vector>

namespace i2b {

struct WantedNode {
    enum Way : std::uint8_t { toCorner, toLine, alongLine };
    Way way = toCorner;
    std::uint32_t at = 0;   // number of the corner or, along a line, of the sample
    std::int32_t vertex = -1;
    std::int32_t face = -1; // one at it, place in Wall::faces,
    std::int32_t cell = -1; // and its cell
    double length = 0;      // in h
    Snap snap;              // where it is to be held
    std::tuple<std::int32_t, Way, std::uint32_t> key() const { return {vertex, way, at}; }
};

class WantedNodes {
  public:
    // Keeps references.
    WantedNodes(const PolyMesh& mesh, const SharpSamples& samples, const Front& front, const WallGuide& guide, const MeshNodes& nodes)
        : mesh_(mesh), samples_(samples), front_(front), guide_(guide), nodes_(nodes) {}

    // For each sample not captured at most one of each way, none that was tried: those to corners first, then those to lines, the shortest
    // of each first, then those along lines, the longest first. The same on any number of threads.
    std::vector<WantedNode> find();
    void markTried(const WantedNode& wanted) { tried_.insert(wanted.key()); }

  private:
    template <class Place>
    WantedNode nearest(const LostSample& sample, const Place& place) const;
    WantedNode toCorner(const LostSample& sample) const;
    WantedNode toLine(const LostSample& sample) const;
    WantedNode alongLine(std::uint32_t sample) const;
    Vec3 tangentAt(const LostSample& sample) const;
    void findTaken();

    const PolyMesh& mesh_;
    const SharpSamples& samples_;
    const Front& front_;
    const WallGuide& guide_;
    const MeshNodes& nodes_;
    std::set<std::tuple<std::int32_t, WantedNode::Way, std::uint32_t>> tried_;
    std::set<std::uint32_t> taken_; // corners at which a node stands
};

} // namespace i2b
