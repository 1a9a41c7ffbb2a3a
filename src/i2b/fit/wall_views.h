// What wall nodes see of the geometry from where they stand, kept: a node that has not moved since, nor its front node, sees what
// it saw. Of what a fit asks for that is a third.
#pragma once
#include "i2b/core/parallel.h"
#include "i2b/core/raw_vector.h"
#include "i2b/fit/between.h"
#include "i2b/fit/fit.h"

namespace i2b {

class WallViews {
  public:
    // Both stay; of the band what nodes see by: their front nodes, and which of these are behind geometry.
    WallViews(const Band& band, const SurfaceIndex& index) : band_(band), index_(index), targets_(band.walls), feet_(band.walls) {
        parallelFor(band.walls, [&](std::size_t n) { targets_[n].isKnown = feet_[n].isKnown = false; }, 2048);
    }
    const Band& band() const { return band_; }
    const SurfaceIndex& index() const { return index_; }
    // wallTarget() and footOf() of a wall node with the band's nodes at x. One node is asked for by one thread at a time.
    const WallTarget& target(std::size_t wall, const Positions& x) {
        return seen(targets_[wall], wall, x, [&](const Vec3& front) { return wallTarget(index_, band_, wall, front, x[wall]); });
    }
    const Foot& foot(std::size_t wall, const Positions& x) {
        return seen(feet_[wall], wall, x, [&](const Vec3&) { return footOf(band_, index_, x, wall); });
    }

  private:
    template <class What>
    struct View {
        Vec3 wall, front; // m, seen from
        What what;
        bool isKnown;
    };
    template <class What, class Look>
    const What& seen(View<What>& view, std::size_t wall, const Positions& x, const Look& look) const {
        const Vec3& front = x[static_cast<std::size_t>(band_.frontNode[wall])];
        if (!view.isKnown || !(view.wall == x[wall]) || !(view.front == front)) view = {x[wall], front, look(front), true};
        return view.what;
    }

    const Band& band_;
    const SurfaceIndex& index_;
    RawVector<View<WallTarget>> targets_;
    RawVector<View<Foot>> feet_;
};

} // namespace i2b
