#include "i2b/layers/columns.h"
#include "i2b/core/flags.h"
#include "i2b/core/parallel.h"
#include "i2b/core/raw_vector.h"
#include "i2b/layers/layer_stack.h"
#include "i2b/layers/wall_normals.h"
#include <algorithm>
#include <array>

namespace i2b {
namespace {

using Index = std::size_t;
constexpr float leastBend = 0.2f;       // below it a bend is none
constexpr double leastRise = 0.2;       // cosine between a column as a whole and the normal
constexpr double goodCorner = 0.75;     // cosine between an edge off the wall and the corner it stands on: no lean to speak of
constexpr double innermost = 0.4;       // the share of a straight one's cosine that the innermost cell may come down to
constexpr double flatCorner = 0.03;     // sine: of a hanging vertex
constexpr Index mostVertices = 16;      // of a face

FrontMesh::FaceHandle faceAt(Index f) { return FrontMesh::FaceHandle(static_cast<int>(f)); }
FrontMesh::VertexHandle vertexAt(Index v) { return FrontMesh::VertexHandle(static_cast<int>(v)); }

// The worst cosines between an edge off the wall and the normal of a corner that it stands on.
struct Upright {
    double layers = 1, innermost = 1;
};

// One face' stack of prisms, for looking at with columns bent and straight.
class Prisms {
  public:
    // heights: of all points of the stack (LayerStack::heights())
    Prisms(const Front& front, const LayerStack& stack, const RawVector<double>& heights) : front_(front), stack_(stack), heights_(heights) {}

    void take(Index face) {
        n_ = 0;
        cells_ = stack_.cellsOf(face);
        for (auto v : front_.mesh.fv_range(faceAt(face))) {
            if (n_ < mostVertices) vertices_[n_++] = static_cast<Index>(v.idx());
        }
    }
    // levels of each vertex: 0 at the wall, cells_ at the front.
    Upright look(const LayerStack& stack) {
        const auto levels = static_cast<Index>(cells_) + 1;
        points_.resize(n_ * levels);
        for (Index i = 0; i < n_; ++i) {
            std::array<Vec3, maxStack + 1> column;
            const Index v = vertices_[i];
            placeLayers(stack, v, front_.front[v], front_.wall(v), &heights_[stack.pointOffset(v)], column.data());
            const auto points = static_cast<Index>(stack.pointsOf(v));
            for (Index k = 0; k + 1 < levels; ++k) points_[k * n_ + i] = column[points - 1 - k];
            points_[(levels - 1) * n_ + i] = front_.front[v];
        }
        Upright seen;
        for (Index k = 0; k + 1 < levels; ++k) {
            double& worst = k + 2 == levels ? seen.innermost : seen.layers;
            worst = std::min(worst, worstCorner(&points_[k * n_], &points_[(k + 1) * n_]));
        }
        return seen;
    }

  private:
    double worstCorner(const Vec3* low, const Vec3* high) const {
        double worst = 1;
        for (Index i = 0; i < n_; ++i) {
            const Index next = i + 1 == n_ ? 0 : i + 1, before = i == 0 ? n_ - 1 : i - 1;
            const Vec3 up = high[i] - low[i];
            for (const Vec3* level : {low, high}) {
                const Vec3 a = level[before] - level[i], b = level[next] - level[i], normal = cross(a, b);
                const double size = norm(normal);
                if (size < flatCorner * norm(a) * norm(b)) continue;
                worst = std::min(worst, dot(normal, up) / (size * norm(up)));
            }
        }
        return worst;
    }

    const Front& front_;
    const LayerStack& stack_;
    const RawVector<double>& heights_;
    int cells_ = 0;
    Index n_ = 0;
    std::array<Index, mostVertices> vertices_{};
    std::vector<Vec3> points_;
};

Upright worse(const Upright& a, const Upright& b) { return {std::min(a.layers, b.layers), std::min(a.innermost, b.innermost)}; }

bool areRight(const Upright& bent, const Upright& straight) {
    return (bent.layers > 0 || bent.layers >= straight.layers) && (bent.innermost > 0 || bent.innermost >= straight.innermost);
}

bool mayStand(const Upright& bent, const Upright& straight) {
    return bent.layers >= std::min(straight.layers, goodCorner) && bent.innermost >= std::min(innermost * straight.innermost, goodCorner);
}

std::vector<Column> fullyBent(const Front& front, const LayerStack& stack) {
    const std::vector<Vec3> normals = wallNormals(front);
    std::vector<Column> columns(normals.size());
    parallelFor(columns.size(), [&](Index v) {
        const Vec3& n = normals[v];
        const bool rises = dot(front.front[v] - front.wall(v), n) > leastRise * roomAt(front, v);
        if (stack.pointsOf(v) > 1) columns[v] = {float(n.x), float(n.y), float(n.z), rises ? 1.0f : 0.0f};
    });
    return columns;
}

RawVector<double> allHeights(const Front& front, const LayerStack& stack) {
    RawVector<double> heights(stack.points());
    parallelFor(stack.vertices, [&](Index v) {
        if (stack.pointsOf(v) > 1) stack.heights(v, roomAt(front, v), &heights[stack.pointOffset(v)]);
    });
    return heights;
}

// Halves the bends of vertices that would stand worse bent than straight, over all faces around.
class Lowering {
  public:
    Lowering(const Front& front, const std::vector<Upright>& bent, const std::vector<Upright>& straight) : front_(front), bent_(bent), straight_(straight) {}

    // Gives whether it did.
    bool lower(Index v, float& bend) const {
        if (bend == 0) return false;
        Upright with, without;
        bool right = true;
        for (auto f : front_.mesh.vf_range(vertexAt(v))) {
            const Upright &b = bent_[Index(f.idx())], &s = straight_[Index(f.idx())];
            with = worse(with, b), without = worse(without, s);
            right = right && areRight(b, s);
        }
        if (right && mayStand(with, without)) return false;
        bend = bend * 0.5f < leastBend ? 0 : bend * 0.5f;
        return true;
    }

  private:
    const Front& front_;
    const std::vector<Upright>&bent_, &straight_; // per face
};

} // namespace

// In rounds: all such vertices at once, and the faces around these are looked at again. One face may be worse off where another was still
// worse.
void bendColumns(const Front& front, LayerStack& stack) {
    if (stack.count == 1 && stack.uniform()) return;
    const LayerStack straight = stack;
    stack.columns = fullyBent(front, stack);
    const RawVector<double> heights = allHeights(front, stack);
    std::vector<std::uint8_t> looks(stack.faces, 1), asked(stack.vertices, 1), lowered;
    std::vector<Upright> bent(stack.faces), upright(stack.faces); // upright: with straight columns
    const Lowering lowering(front, bent, upright);
    for (bool first = true, again = true; again; first = false) {
        parallelChunks(stack.faces, 256, [&](Index begin, Index end, Index) {
            if (!anyFlag(looks, begin, end)) return;
            Prisms prisms(front, stack, heights);
            for (Index f = begin; f < end; ++f) {
                if (!looks[f] || stack.cellsOf(f) < 2) continue;
                prisms.take(f);
                bent[f] = prisms.look(stack);
                if (first) upright[f] = prisms.look(straight);
            }
        });
        if (!first)
            forFlagged(looks, [&](Index f) {
                for (auto v : front.mesh.fv_range(faceAt(f))) setFlag(asked[Index(v.idx())]);
            });
        lowered.assign(stack.vertices, 0);
        forFlagged(asked, [&](Index v) { lowered[v] = lowering.lower(v, stack.columns[v].bend); });
        looks.assign(stack.faces, 0), asked.assign(stack.vertices, 0);
        forFlagged(lowered, [&](Index v) {
            for (auto f : front.mesh.vf_range(vertexAt(v))) setFlag(looks[Index(f.idx())]);
        });
        again = anyFlag(looks, 0, looks.size());
    }
}

} // namespace i2b
