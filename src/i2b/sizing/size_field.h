// From the user's few numbers to the lattice and a level for every place. In most cases the user gives one number,
// the largest cell that may meet the geometry; the rest follows from the extent (Wang and Srinivasan 2002, section 3).
#pragma once
#include "i2b/core/lattice.h"
#include "i2b/geometry/surface.h"
#include "i2b/options.h"
#include "i2b/sizing/shapes.h"
#include <cstdint>
#include <string>
#include <vector>

namespace i2b {

struct LevelBox {
    Box box;           // m
    LevelTriple level;
};

struct LevelShape {
    Shape shape;
    LevelTriple level;
};

// Single cells that are to be there, ascending.
struct LevelCells {
    LevelTriple level;
    std::vector<Index3> cells;
};

struct SizeField {
    Lattice lattice;
    std::vector<LevelTriple> partLevel;  // per part: level of the cells that it meets
    std::vector<LevelTriple> triangleLevel; // per triangle, at least its part's; empty: the parts' alone
    std::vector<LevelBox> boxes;         // refinement boxes
    std::vector<LevelShape> shapes;      // and all other places that a size is asked for
    std::vector<LevelCells> gaps;        // cells across narrow gaps, by level
    int bufferCells = 3;
    double surfaceSize = 0, minSize = 0, maxSize = 0; // m: asked d_int, smallest and largest cell edge that result
    std::vector<std::string> notes;      // what was clamped, and what was asked for in vain

    LevelTriple target(const Surface& surface, std::size_t triangle) const {
        return triangleLevel.empty() ? partLevel[static_cast<std::size_t>(surface.partOf[triangle])] : triangleLevel[triangle];
    }
    std::vector<LevelTriple> targets() const; // of all triangles, each once, ascending
    std::string validate() const;
};

// Throws Error where no lattice fits the request (empty geometry, box that misses it, more than 2^28 cells along an
// axis). index: of the surface, which spares bands around most of it one of their own; it must then outlive the field.
SizeField makeSizeField(const Surface& surface, const SizeOptions& size, const DomainOptions& domain, const SurfaceIndex* index = nullptr);

// Sets the lattice's finest level to what the field asks for. Throws Error where that is too fine for the lattice.
void settleLevels(SizeField& field);

// The level whose cells are no larger than size. One size for all axes gives one level: base cells are cubes as nearly
// as the domain allows. Throws Error where that is too fine.
LevelTriple levelFor(const Lattice& lattice, const Vec3& size);

} // namespace i2b
