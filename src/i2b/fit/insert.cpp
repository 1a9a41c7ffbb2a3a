#include "i2b/fit/insert.h"
#include "i2b/core/collect.h"
#include "i2b/core/flags.h"
#include "i2b/fit/face_cuts.h"
#include "i2b/fit/wall_views.h"
#include "i2b/front/replace_faces.h"
#include <algorithm>
#include <array>
#include <map>

namespace i2b {
namespace {

constexpr int placesTried = 8; // equal parts of an edge of the front, at whose ends a vertex may stand
constexpr std::array slides{0.0, 0.1, -0.1, 0.2, -0.2, 0.3, -0.3, 0.4, -0.4}; // of h: so far along its line,
constexpr double goodCorner = 0.15; // scaled Jacobian: no farther than to have such corners,
constexpr int placingRounds = 2;    // and again after those beside it have
constexpr double stepAside = 0.04;  // of h: off an edge into the one of its faces that is cut
constexpr std::size_t leastLines = 3; // that a corner beyond an edge must be at the end of

class Inserter {
  public:
    Inserter(Front& front, WallViews& views, const FeatureIndex& features, Positions& x,
             std::vector<Snap>& snaps, const std::vector<Snap>& wishes)
        : front_(front), band_(views.band()), index_(views.index()), features_(features), x_(x), snaps_(snaps), marks_(markWall(views, features, x, snaps, wishes)),
          cutter_(front_, band_, index_, features_, x_, marks_, crossings_, crossingOf_) {}
    std::size_t run();

  private:
    bool isOfWholeFace(std::int32_t edge) const;
    void lookForCrossings();
    void takeCorners();
    double gainOf(std::int32_t crossing) const;
    std::vector<RoomWish> roomWanted(const std::vector<FaceCuts>& cuts) const;
    std::vector<std::uint8_t> stepAsideWhereRefused(const std::vector<FaceCuts>& cuts);
    std::array<std::int32_t, 2> placesBeside(std::int32_t edge) const;
    double cornerBeside(const EdgeCrossing& crossing, const std::vector<FaceCuts>& cuts) const;
    EdgeCrossing bestPlaceOf(const EdgeCrossing& crossing, const std::vector<FaceCuts>& cuts) const;
    bool mayKeepSome(const FaceCuts& cuts) const;
    bool prune(const std::vector<FaceCuts>& cuts);
    void stepIntoCutFaces(const std::vector<FaceCuts>& cuts);
    void apply(const std::vector<FaceCuts>& cuts);

    Front& front_;
    const Band& band_;
    const SurfaceIndex& index_;
    const FeatureIndex& features_;
    Positions& x_;
    std::vector<Snap>& snaps_;
    const WallMarks marks_;
    std::vector<EdgeCrossing> crossings_;
    std::vector<std::int32_t> crossingOf_;  // per edge of the front; -1: none
    RawVector<std::int32_t> faces_;          // that may be cut, ascending
    const FaceCutter cutter_;
};

// Where a cut is refused for the want of it.
std::vector<RoomWish> Inserter::roomWanted(const std::vector<FaceCuts>& cuts) const {
    std::vector<RoomWish> wishes;
    for (const FaceCuts& c : cuts) {
        if (c.valid || c.pieces.size() < 2) continue;
        for (const CutRing& piece : c.pieces) cutter_.wishRoom(piece, wishes);
    }
    return wishes;
}

// May a face that cannot take all its cuts take those that lines ask for? Not round a rim: there one alone leaves the rest standing across it.
bool Inserter::mayKeepSome(const FaceCuts& cuts) const {
    bool anyOptional = false, anyRim = false;
    for (const CutRing& piece : cuts.pieces) {
        for (const CutPlace& p : piece) {
            anyOptional = anyOptional || cutter_.isOptional(p);
            anyRim = anyRim || (p.crossing >= 0 && crossings_[std::size_t(p.crossing)].onRim);
        }
    }
    return anyOptional && !anyRim;
}

// Gives up crossings of faces that cannot take them, and those that end no cut; beside one on a line those that need not be come first.
// False: nothing to give up.
bool Inserter::prune(const std::vector<FaceCuts>& cuts) {
    std::vector<std::uint8_t> used(crossings_.size(), 0), refused(crossings_.size(), 0);
    parallelFor(cuts.size(), [&](std::size_t i) {
        const bool keepsSome = !cuts[i].valid && mayKeepSome(cuts[i]);
        for (const CutRing& piece : cuts[i].pieces) {
            for (const CutPlace& p : piece) {
                if (p.crossing < 0) continue;
                if (p.isEnd) setFlag(used[std::size_t(p.crossing)]);
                if (!cuts[i].valid && (!keepsSome || cutter_.isOptional(p))) setFlag(refused[std::size_t(p.crossing)]);
            }
        }
    });
    bool any = false;
    for (std::size_t i = 0; i < crossings_.size(); ++i) {
        if (!crossings_[i].alive || (used[i] && !refused[i])) continue;
        crossings_[i].alive = false;
        any = true;
    }
    return any;
}

// A cut is refused where a prism of it would fold: its crossings are then where the prisms beside them are best. Gives the faces, as places
// in cuts, beside those that moved.
std::vector<std::uint8_t> Inserter::stepAsideWhereRefused(const std::vector<FaceCuts>& cuts) {
    std::vector<std::uint8_t> refused(crossings_.size(), 0), beside(cuts.size(), 0);
    for (const FaceCuts& c : cuts) {
        if (c.valid || c.pieces.size() < 2) continue;
        for (const CutRing& piece : c.pieces) {
            for (const CutPlace& p : piece) {
                if (p.crossing >= 0) refused[std::size_t(p.crossing)] = 1;
            }
        }
    }
    std::vector<EdgeCrossing> best(crossings_.size());
    parallelFor(crossings_.size(), [&](std::size_t i) {
        if (refused[i]) best[i] = bestPlaceOf(crossings_[i], cuts);
    }, 16);
    for (std::size_t i = 0; i < crossings_.size(); ++i) {
        if (!refused[i] || (best[i].t == crossings_[i].t && best[i].wall == crossings_[i].wall)) continue;
        crossings_[i] = best[i];
        for (const std::int32_t place : placesBeside(crossings_[i].edge)) {
            if (place >= 0) beside[std::size_t(place)] = 1;
        }
    }
    return beside;
}

// The faces at both sides of an edge, as places in faces_; -1: none, or not to be cut.
std::array<std::int32_t, 2> Inserter::placesBeside(std::int32_t edge) const {
    std::array<std::int32_t, 2> places{-1, -1};
    for (const unsigned side : {0u, 1u}) {
        const auto face = front_.mesh.face_handle(front_.mesh.halfedge_handle(FrontMesh::EdgeHandle(edge), side));
        const auto at = std::lower_bound(faces_.begin(), faces_.end(), face.idx());
        if (face.is_valid() && at != faces_.end() && *at == face.idx()) places[side] = static_cast<std::int32_t>(at - faces_.begin());
    }
    return places;
}

// The worst corner of the prisms at both sides of a crossing's edge.
double Inserter::cornerBeside(const EdgeCrossing& crossing, const std::vector<FaceCuts>& cuts) const {
    double corner = 1;
    for (const std::int32_t face : placesBeside(crossing.edge))
        if (face >= 0) corner = std::min(corner, cutter_.worstCorner(cuts[std::size_t(face)].pieces, crossing));
    return corner;
}

// On the front as straight under its place on the wall as the edge allows, or at a share of it; on the wall where it is, or along the line as
// little as will do: whichever gives the best corners, the first of equals.
EdgeCrossing Inserter::bestPlaceOf(const EdgeCrossing& crossing, const std::vector<FaceCuts>& cuts) const {
    EdgeCrossing best = crossing;
    double bestCorner = cornerBeside(crossing, cuts);
    const auto look = [&](EdgeCrossing c, double t) {
        placeOnFront(band_, x_, c, t);
        const double corner = cornerBeside(c, cuts);
        if (corner <= bestCorner || !isFree(index_, c)) return;
        bestCorner = corner, best = c;
    };
    const double h = band_.h[std::size_t(crossing.p)];
    for (const double slide : slides) {
        EdgeCrossing c = crossing;
        if (slide != 0 && !slideAlong(index_, features_, c, slide * h)) continue;
        look(c, shareUnder(band_, x_, c));
        for (int i = 1; i < placesTried; ++i) look(c, double(i) / placesTried);
        if (bestCorner >= goodCorner) break;
    }
    return best;
}

// Where a cut ends at an edge whose other face goes on uncut, the prism there would have two sides in one plane, which counts as concave: a
// little into the face that is cut, along its line, the vertex makes it convex. In their order, as each changes the corners of the next.
void Inserter::stepIntoCutFaces(const std::vector<FaceCuts>& cuts) {
    std::vector<Vec3> into(crossings_.size()); // from the vertex to the other ends of its cuts
    std::vector<std::uint8_t> passed(crossings_.size(), 0);
    for (const FaceCuts& c : cuts) {
        for (const CutRing& piece : c.pieces) {
            for (std::size_t i = 0, n = piece.size(); i < n; ++i) {
                if (piece[i].crossing < 0) continue;
                const auto at = static_cast<std::size_t>(piece[i].crossing);
                if (!piece[i].isEnd) passed[at] = 1;
                for (const CutPlace& next : {piece[(i + 1) % n], piece[(i + n - 1) % n]})
                    if (piece[i].isEnd && next.star) into[at] += normalized(cutter_.wallAt(next) - crossings_[at].wall);
            }
        }
    }
    std::vector<EdgeCrossing> stepped(crossings_.size());
    parallelFor(crossings_.size(), [&](std::size_t i) {
        EdgeCrossing c = crossings_[i];
        if (!c.alive || !passed[i] || into[i] == Vec3{} || c.corner >= 0) return;
        const double step = stepAside * band_.h[std::size_t(c.p)];
        if (c.kind != SnapKind::none) {
            if (!slideAlong(index_, features_, c, dot(into[i], c.tangent) < 0 ? -step : step)) return;
        } else {
            const ClosestPoint on = index_.closest(c.wall + normalized(into[i]) * step, step);
            if (!on) return;
            c.wall = on.point;
        }
        placeOnFront(band_, x_, c, c.t);
        if (isFree(index_, c)) stepped[i] = c;
    }, 64);
    for (std::size_t i = 0; i < crossings_.size(); ++i) {
        if (stepped[i].alive && cornerBeside(stepped[i], cuts) >= std::min(cornerBeside(crossings_[i], cuts), goodCorner)) crossings_[i] = stepped[i];
    }
}

void Inserter::apply(const std::vector<FaceCuts>& cuts) {
    std::vector<std::int32_t> vertexOf(crossings_.size(), -1);
    const auto lattice = static_cast<std::int32_t>(front_.corePoints);
    const auto added = static_cast<std::size_t>(std::ranges::count_if(crossings_, &EdgeCrossing::alive));
    const auto makeRoomIn = [&](auto&... lists) { (lists.reserve(lists.size() + added), ...); }; // once, and no more than it takes
    makeRoomIn(front_.corePoint, front_.front, front_.h, front_.size, front_.inside, front_.direction, front_.outside, snaps_);
    for (std::size_t i = 0; i < crossings_.size(); ++i) {
        const EdgeCrossing& c = crossings_[i];
        if (!c.alive) continue;
        const auto p = static_cast<std::size_t>(c.p), q = static_cast<std::size_t>(c.q);
        vertexOf[i] = static_cast<std::int32_t>(front_.front.size());
        front_.mesh.add_vertex({c.wall.x, c.wall.y, c.wall.z});
        front_.corePoint.push_back(lattice + static_cast<std::int32_t>(front_.inserted.size()));
        front_.front.push_back(c.front);
        front_.h.push_back(std::min(front_.h[p], front_.h[q]));
        front_.size.push_back(cwiseMin(front_.size[p], front_.size[q]));
        front_.inside.push_back(front_.inside[p] + (front_.inside[q] - front_.inside[p]) * c.t);
        front_.direction.push_back(front_.direction[p]);
        front_.outside.push_back(front_.outside[p] & front_.outside[q]);
        front_.inserted.push_back({{c.p, c.q}, c.t});
        snaps_.push_back({c.kind, c.wall, c.tangent});
    }
    std::vector<FaceCut> faceCuts;
    for (std::size_t i = 0; i < cuts.size(); ++i) {
        const bool whole = !cuts[i].valid || (cuts[i].pieces.size() == 1 && std::all_of(cuts[i].pieces[0].begin(), cuts[i].pieces[0].end(), [](const CutPlace& p) { return p.vertex >= 0; }));
        if (whole) continue;
        FaceCut& cut = faceCuts.emplace_back();
        cut.face = faces_[i];
        for (const CutRing& piece : cuts[i].pieces) {
            std::vector<std::int32_t>& polygon = cut.polygons.emplace_back();
            for (const CutPlace& p : piece) polygon.push_back(p.vertex >= 0 ? p.vertex : vertexOf[std::size_t(p.crossing)]);
        }
    }
    replaceFaces(front_, faceCuts);
}

bool Inserter::isOfWholeFace(std::int32_t edge) const {
    for (const unsigned side : {0u, 1u}) {
        const auto face = front_.mesh.face_handle(front_.mesh.halfedge_handle(FrontMesh::EdgeHandle(edge), side));
        if (face.is_valid() && front_.staysWhole(static_cast<std::size_t>(face.idx()))) return true;
    }
    return false;
}

void Inserter::lookForCrossings() {
    crossings_ = findCrossings(front_, band_, index_, features_, x_, marks_);
    std::erase_if(crossings_, [&](const EdgeCrossing& c) { return isOfWholeFace(c.edge); });
    crossingOf_.assign(front_.mesh.n_edges(), -1);
    for (std::size_t i = 0; i < crossings_.size(); ++i) crossingOf_[std::size_t(crossings_[i].edge)] = static_cast<std::int32_t>(i);
    faces_ = collect<std::int32_t>(front_.ownerCell.size(), [&](std::size_t f, const auto& put) {
        std::size_t stars = 0, crossed = 0;
        for (auto he : front_.mesh.fh_range(FrontMesh::FaceHandle(static_cast<int>(f)))) {
            stars += marks_.onLine[std::size_t(front_.mesh.from_vertex_handle(he).idx())];
            crossed += crossingOf_[std::size_t(front_.mesh.edge_handle(he).idx())] >= 0;
        }
        if ((crossed > 0 || stars > 1) && !front_.staysWhole(f)) put(static_cast<std::int32_t>(f));
    }, 2048);
}

// What a corner beyond an edge brings: the worst scaled Jacobian of the cells beside the edge; 0: too few lines lead to it, or it may not be.
double Inserter::gainOf(std::int32_t crossing) const {
    const EdgeCrossing& c = crossings_[std::size_t(crossing)];
    std::vector<CutRing> pieces;
    for (const std::int32_t place : placesBeside(c.edge)) {
        if (place < 0) return 0;
        const FaceCuts cuts = cutter_.cutsOf(static_cast<std::size_t>(faces_[std::size_t(place)]), crossing);
        if (!cuts.valid) return 0;
        pieces.insert(pieces.end(), cuts.pieces.begin(), cuts.pieces.end());
    }
    return cutter_.linesFrom(crossing, pieces) >= leastLines ? cutter_.worstCorner(pieces, c) : 0;
}

// Each corner that the wall does not reach becomes one of the places beyond edges that were found for it: the one with the best cells.
void Inserter::takeCorners() {
    std::vector<double> gain(crossings_.size(), 0);
    parallelFor(crossings_.size(), [&](std::size_t i) {
        if (crossings_[i].corner >= 0) gain[i] = gainOf(static_cast<std::int32_t>(i));
    }, 16);
    std::map<std::int64_t, std::size_t> best; // by corner
    for (std::size_t i = 0; i < crossings_.size(); ++i) {
        if (gain[i] < goodCorner) continue;
        const auto [at, isNew] = best.insert({crossings_[i].corner, i});
        if (!isNew && gain[i] > gain[at->second]) at->second = i;
    }
    for (const auto& [corner, i] : best) crossings_[i].alive = true;
}

std::size_t Inserter::run() {
    lookForCrossings();
    takeCorners();
    std::vector<FaceCuts> cuts;
    const auto cutAll = [&](const auto& isWanted) {
        cuts.resize(faces_.size());
        parallelFor(faces_.size(), [&](std::size_t i) {
            if (isWanted(i)) cuts[i] = cutter_.cutsOf(static_cast<std::size_t>(faces_[i]));
        }, 64);
    };
    const auto any = [](std::size_t) { return true; };
    cutAll(any);
    if (makeRoom(roomWanted(cuts), band_, index_, x_, front_) > 0) {
        followFront(band_, index_, x_, crossings_);
        cutAll(any);
    }
    for (int round = 0; round < placingRounds; ++round) {
        const std::vector<std::uint8_t> changed = stepAsideWhereRefused(cuts);
        cutAll([&](std::size_t i) { return changed[i] != 0; });
    }
    const auto isStale = [&](const FaceCuts& c) {
        return std::any_of(c.pieces.begin(), c.pieces.end(), [&](const CutRing& piece) {
            return std::any_of(piece.begin(), piece.end(), [&](const CutPlace& p) { return p.crossing >= 0 && !crossings_[std::size_t(p.crossing)].alive; });
        });
    };
    while (prune(cuts)) cutAll([&](std::size_t i) { return isStale(cuts[i]); });
    stepIntoCutFaces(cuts);
    apply(cuts);
    return front_.inserted.size();
}

} // namespace

std::size_t insertVertices(Front& front, WallViews& views, const FeatureIndex& features, Positions& x,
                           std::vector<Snap>& snaps, const std::vector<Snap>& wishes) {
    return Inserter(front, views, features, x, snaps, wishes).run();
}

} // namespace i2b
