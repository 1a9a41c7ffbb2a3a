#include "i2b/front/replace_faces.h"
#include "i2b/core/sums.h"
#include "i2b/front/join_faces.h"

namespace i2b {
namespace {

using Index = std::size_t;

// Which new faces each face gives, and which sides.
class Replacement {
  public:
    Replacement(const Front& front, const std::vector<FaceCut>& cuts) : front_(front), cutOf_(front.ownerCell.size(), nullptr) {
        for (const FaceCut& cut : cuts) cutOf_[Index(cut.face)] = &cut;
        face_ = sumsBefore<Index>(cutOf_.size(), [&](Index f) { return cutOf_[f] ? cutOf_[f]->polygons.size() : 1; });
        side_ = sumsBefore<Index>(cutOf_.size(), [&](Index f) {
            if (!cutOf_[f]) return Index(front.mesh.valence(handle(f)));
            Index n = 0;
            for (const auto& polygon : cutOf_[f]->polygons) n += polygon.size();
            return n;
        });
    }
    Index faces() const { return face_.back(); }

    Polygons polygons() const {
        Polygons out;
        out.vertices.resize(side_.back()), out.start.resize(faces() + 1);
        out.start.back() = side_.back();
        parallelFor(cutOf_.size(), [&](Index f) {
            Index face = face_[f], side = side_[f];
            const auto begin = [&] { out.start[face++] = side; };
            if (!cutOf_[f]) {
                begin();
                for (auto v : front_.mesh.fv_range(handle(f))) out.vertices[side++] = v.idx();
                return;
            }
            for (const auto& polygon : cutOf_[f]->polygons) {
                begin();
                for (const std::int32_t v : polygon) out.vertices[side++] = v;
            }
        }, 2048);
        return out;
    }
    // Each new face has the value of the old one.
    template <class T>
    std::vector<T> spread(const std::vector<T>& values) const {
        std::vector<T> out(faces());
        parallelFor(values.size(), [&](Index f) { std::fill(out.begin() + at(f), out.begin() + at(f + 1), values[f]); }, 2048);
        return out;
    }
    // The first face of a lattice face counts them all.
    std::vector<std::uint8_t> pieces() const {
        std::vector<std::uint8_t> out(faces(), 0);
        parallelFor(cutOf_.size(), [&](Index f) {
            if (const Index n = front_.pieces[f]; n > 0) out[face_[f]] = static_cast<std::uint8_t>(face_[f + n] - face_[f]);
        }, 2048);
        return out;
    }

  private:
    static FrontMesh::FaceHandle handle(Index f) { return FrontMesh::FaceHandle(static_cast<int>(f)); }
    std::ptrdiff_t at(Index f) const { return static_cast<std::ptrdiff_t>(face_[f]); }
    const Front& front_;
    std::vector<const FaceCut*> cutOf_; // per face, null: stays
    RawVector<Index> face_, side_;      // per face, and one more: its first new face, its first side
};

} // namespace

void replaceFaces(Front& front, const std::vector<FaceCut>& cuts) {
    if (cuts.empty()) return;
    const Replacement replacement(front, cuts);
    FrontMesh mesh = joinFaces(front.mesh.n_vertices(), [&](Index v) { return front.mesh.point(FrontMesh::VertexHandle(static_cast<int>(v))); }, replacement.polygons(), "the cut front is not manifold");
    front.ownerCell = replacement.spread(front.ownerCell);
    front.part = replacement.spread(front.part);
    front.level = replacement.spread(front.level);
    front.pieces = replacement.pieces();
    front.mesh = std::move(mesh);
}

} // namespace i2b
