// What is to become of the cells and faces of a mesh, before it does: groups of cells that are to be one, faces that are to
// be divided; and a group with what lies around it as a small mesh of its own, so that the measures of whole meshes can
// judge what another change would bring.
#pragma once
#include "i2b/assemble/edit_mesh.h"
#include "i2b/assemble/mesh_topology.h"
#include <cstdint>
#include <span>
#include <map>
#include <unordered_map>
#include <vector>

namespace i2b {

// A group is named by its lowest cell. Keeps references.
class LocalEdits {
  public:
    LocalEdits(const PolyMesh& mesh, const Rows& cellFaces);

    std::int32_t of(std::int32_t cell) const {
        return isGrouped_[static_cast<std::size_t>(cell)] ? groupOf_.at(cell) : cell;
    }
    class Cells { // of a group: most are of one
      public:
        explicit Cells(std::int32_t own) : own_(own) {}
        explicit Cells(std::span<const std::int32_t> all) : all_(all) {}
        const std::int32_t* begin() const { return all_.empty() ? &own_ : all_.data(); }
        const std::int32_t* end() const { return begin() + size(); }
        std::size_t size() const { return all_.empty() ? 1 : all_.size(); }

      private:
        std::int32_t own_ = -1;
        std::span<const std::int32_t> all_;
    };
    Cells cells(std::int32_t group) const;
    void unite(std::int32_t a, std::int32_t b); // groups
    void divide(std::int32_t face, std::uint32_t from) { divided_[face] = from; } // as trianglesOf() does
    bool isDivided(std::int32_t face) const { return divided_.contains(face); }
    MeshEdits edits() const;
    std::int64_t united() const { return united_; }
    std::int64_t divided() const { return static_cast<std::int64_t>(divided_.size()); }

    // Faces of a group to others and out of the domain.
    void facesOf(std::int32_t group, std::vector<std::int32_t>& faces) const;
    // The group at the other side of such a face; -1: none.
    std::int32_t across(std::int32_t face, std::int32_t group) const;
    // Do two groups meet in one face, with all the points that they share?
    bool meetInOneFace(std::int32_t a, std::int32_t b) const;
    bool shareNoPoint(std::int32_t a, std::int32_t b) const;

    std::vector<std::int32_t> neighboursOf(const std::vector<std::int32_t>& groups) const; // with these, ascending
    // Some groups with all their neighbours, and what is tried of them.
    struct Trial {
        std::vector<std::int32_t> groups; // ascending
        bool united = false;       // as one cell
        std::int32_t face = -1;    // divided
        std::uint32_t from = 0;    // one of its vertices, or widest
    };
    struct Surroundings {
        PolyMesh mesh;
        std::vector<std::uint8_t> outerCells, outerFaces; // 1: of neighbours only
    };
    Surroundings around(const Trial& trial) const;

  private:
    std::size_t sharedPoints(std::int32_t a, std::int32_t b) const;
    void pointsOf(std::int32_t group, std::vector<std::int32_t>& points) const;

    const PolyMesh& mesh_;
    const Rows& cellFaces_;
    std::vector<bool> isGrouped_;                                            // per cell: is its group one of more than one?
    std::unordered_map<std::int32_t, std::int32_t> groupOf_;                 // of these
    std::unordered_map<std::int32_t, std::vector<std::int32_t>> members_;    // of groups of more than one
    std::map<std::int32_t, std::uint32_t> divided_;
    std::int64_t united_ = 0;
};

} // namespace i2b
