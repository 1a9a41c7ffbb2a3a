// The conforming polyhedral mesh that kept cells make, without storing it: numbers for cells, points and fans from
// ranked masks (bits per cell), and the polygons of any cell on request.
//
// Where cells of different levels meet, the faces are the pieces that their own faces have in common (each may be the
// finer one along one axis), and every polygon carries the vertex on the middle of its edge wherever any cell has a
// corner there. A lattice vertex whose kept cells fall into several
// face-connected components is one point per component.
#pragma once
#include "i2b/carve/kept_cells.h"
#include "i2b/carve/vertices.h"
#include "i2b/core/raw_vector.h"
#include "i2b/grid/ranked_mask.h"

namespace i2b {

enum class FaceKind : std::uint8_t { internal, front, side };

// A face of a kept cell, seen from it: the polygon's normal points out of the cell.
struct CellFace {
    FaceKind kind = FaceKind::internal;
    std::uint8_t side = 0;                // domain side 2 * axis (+ 1 for the high one), where kind is side
    std::uint8_t level = 0;               // finest over the axes, of the finer of the two cells: the face's size
    std::uint8_t vertices = 0;            // 4 to 8
    std::int64_t other = -1;              // cell number across, where kind is internal
    std::array<std::int32_t, 8> points{}; // core point numbers
    std::array<std::int32_t, 8> fans{};   // front vertex numbers, where kind is front
};

class LatticeMesh {
  public:
    // Keeps references: grid and kept must outlive it. Throws Error(input) beyond 2^31 points or cells.
    LatticeMesh(const CellGrid& grid, const KeptCells& kept);

    const Lattice& lattice() const { return grid_.lattice; }
    int levels() const { return static_cast<int>(cells_.size()); }       // of cells: as in CellGrid
    int pointLevels() const { return static_cast<int>(points_.size()); } // of points: as activeVertices() has them
    const LevelTriple& levelOf(int level) const { return grid_.levels[static_cast<std::size_t>(level)].level; }
    bool cubes() const { // no cell has levels that differ from axis to axis
        return std::all_of(grid_.levels.begin(), grid_.levels.end(), [](const CellLevel& l) { return l.level.same(); });
    }
    std::int64_t cellCount() const { return cellCount_; }
    std::int64_t pointCount() const { return pointCount_ + extraPoints_; } // core points
    std::int64_t fanCount() const { return fanCount_; }
    const RankedMask& cells(int level) const { return cells_[static_cast<std::size_t>(level)]; }
    const RankedMask& points(int level) const { return points_[static_cast<std::size_t>(level)]; }
    const RankedMask& frontPoints(int level) const { return frontPoints_[static_cast<std::size_t>(level)]; }

    struct FrontPoint {                // one lattice vertex of the front
        std::uint8_t pattern = 0, outside = 0;
        std::int32_t firstFan = 0;     // its fans are firstFan, firstFan + 1, ...
        std::int32_t firstExtra = 0;   // number of the point of component 1; component 0 has the vertex' own number
        std::int32_t point = 0;        // number of the point of component 0
    };
    const FrontPoint& frontPoint(std::int64_t slot) const { return front_[static_cast<std::size_t>(slot)]; }
    std::int64_t frontPointCount() const { return static_cast<std::int64_t>(front_.size()); }

    // Positions of all core points on the lattice, m.
    RawVector<Vec3> latticePoints(std::size_t room = 0) const; // room: memory for so many more
    Vec3 latticePoint(std::int32_t point) const;               // of one, where few are asked for

    // Cached look-ups: one Reader per thread.
    class Reader {
      public:
        explicit Reader(const LatticeMesh& mesh);
        // visit(const CellFace&) for every face of the kept cell, in fixed order; of the internal ones only those to cells
        // whose number is above `above`.
        template <class Visit>
        void faces(int level, const Index3& c, const Visit& visit, std::int64_t above = -1) {
            enter(level, c);
            above_ = above;
            for (int direction = 0; direction < 6; ++direction) {
                const int n = neighbours(level, c, direction);
                for (int i = 0; i < n; ++i) visit(found_[static_cast<std::size_t>(i)]);
            }
        }
        // The points at the corners of a kept cell that has no others, by bits x, y, z (1: the upper end); false where finer cells
        // may have put points on its edges and faces.
        bool corners(int level, const Index3& c, std::array<std::int32_t, 8>& points);
        // The cells of a node whose 26 neighbours are all kept cells of their own level. Their faces have four vertices each, none on
        // the front, and an internal face to the next cell of each axis has a cell of a higher number beyond it.
        LeafBits deepCells(int level, std::size_t node);
        // visit(number of the cell beyond, points) for the upper faces of such a cell, with ascending numbers; polygons as of faces().
        template <class Visit>
        void upperFaces(int level, const Index3& c, const Visit& visit) {
            std::array<Upper, 3> upper;
            lookUp(level, c, upper);
            for (const Upper& face : upper) visit(face.other, face.points);
        }
        std::int64_t cell(int level, const Index3& c) { return kept_[std::size_t(level)].rank(c); }
        // Kept cells around a point (of its own level): calls visit(level, cell) up to eight times, with repeats.
        template <class Visit>
        void cellsAround(int pointLevel, const Index3& v, const Visit& visit) {
            for (const Octant& o : lookup_.view(pointLevel, v).octants) {
                if (o.kept) visit(static_cast<int>(o.level), o.cell);
            }
        }

      private:
        // A face before it is a polygon, in quarters of the cell's edges.
        struct Piece {
            Index3 low{}, high{}; // equal along axis
            int axis = 0, side = 0;
        };
        struct Upper {
            std::int32_t other = 0;
            std::array<std::int32_t, 4> points{};
        };
        void lookUp(int level, const Index3& c, std::array<Upper, 3>& upper);
        int neighbours(int level, const Index3& c, int direction); // fills found_
        int piecesAcross(int level, const Index3& c, std::size_t axis, int side);
        bool hasCell(int level, const Index3& c) { return cells_[static_cast<std::size_t>(level)].isValueOn(toCoord(c)); }
        void fill(CellFace& face, int level, const Piece& piece);
        void addVertex(CellFace& face, int level, const Piece& piece, const Index3& at);
        // What is at a place in quarters of a cell's edges: looked up once a node of the mask, used by the faces of up to
        // eight cells.
        struct Spot {
            std::uint32_t node = 0;   // running number of the node it was looked up for
            std::int32_t point = -1;  // -1: no point there
            std::int32_t front = -1;  // index of its FrontPoint; -1: not on the front
        };
        void enter(int level, const Index3& c);
        bool mayHaveFiner(int level, const Index3& node);
        Spot spotAt(int level, const Index3& at);
        std::int32_t pointAt(const Spot& spot, int octant) const; // as the cell in an octant around it has it
        Spot findPoint(const Index3& at, const LevelTriple& quarter, int finest);

        const LatticeMesh& mesh_;
        std::vector<std::vector<std::size_t>> touching_;
        std::vector<RankedMask::Reader> kept_, points_, frontPoints_;
        std::vector<MaskReader> cells_;
        VertexLookup lookup_;
        std::array<CellFace, 4> found_{};
        bool isCubes_ = false;
        static constexpr int spotsAlong = 17; // of a node: at the corners of its cells and halfway between
        std::vector<Spot> spots_;
        std::uint32_t node_ = 0;
        bool hasFiner_ = true;   // points finer than the node's cells may lie in it
        int nodeLevel_ = -1;
        Index3 nodeAt_{};        // its first cell / 8
        Index3 origin_{};        // of the node, in quarters of its cells' edges
        std::int64_t above_ = -1;
    };

  private:
    const CellGrid& grid_;
    const KeptCells& kept_;
    std::vector<RankedMask> cells_, points_, frontPoints_;
    std::vector<FrontPoint> front_;
    std::int64_t cellCount_ = 0, pointCount_ = 0, extraPoints_ = 0, fanCount_ = 0;
};

} // namespace i2b
