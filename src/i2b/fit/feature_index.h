// Closest places on the lines and corners of a feature graph.
#pragma once
#include "i2b/geometry/features.h"
#include "i2b/geometry/surface_index.h"
#include <memory>

namespace i2b {

enum class Creases : std::uint8_t { kept, leftOut };

// Closest line (an edge of lineKinds) and closest corner of a feature graph.
class FeatureIndex {
  public:
    explicit FeatureIndex(const FeatureGraph& graph, Creases creases = Creases::kept);
    bool empty() const { return lines_.triangles.empty(); }

    struct Line {
        Vec3 point, tangent; // tangent: unit
        bool found = false;
        bool isRim = false;   // where a sheet ends
        bool isFaint = false; // folds by so little, if at all, that the normals at its sides do not tell
    };
    Line closestLine(const Vec3& q, double radius) const;
    bool hasFaint() const { return hasFaint_; }
    Line closestFaint(const Vec3& q, double radius) const; // of the faint ones
    // Creases are no lines: nothing else here counts them.
    bool hasCreases() const { return creaseIndex_ != nullptr; }
    double creaseCosine() const { return creaseCosine_; } // the cosine of the fold over which there may be one
    Line closestCrease(const Vec3& q, double radius) const;
    Line closestCrease(const Vec3& q, double radius, float leastFold) const; // of those that fold by more, degrees
    // Comes another line within radius of this one's point, and nowhere so near to its tangent as aside?
    bool hasOtherBeside(const Line& line, double radius, double aside) const;
    ClosestPoint closestCorner(const Vec3& q, double radius) const; // triangle: number among the corners
    bool isCrowded(const ClosestPoint& corner, double radius) const; // is another one within radius of it?
    bool isFaint(const ClosestPoint& corner) const { return isFaintCorner_[corner.triangle] != 0; } // do none but faint lines meet there?

  private:
    Line lineAt(const ClosestPoint& place) const;

    Surface lines_, creases_, corners_; // segments and points as degenerate triangles
    std::vector<std::uint8_t> isRim_, isFaint_; // of lines_
    std::vector<float> creaseFold_;             // degrees, of creases_
    std::vector<std::uint8_t> isFaintCorner_;   // of corners_
    bool hasFaint_ = false;
    double creaseCosine_;
    std::unique_ptr<SurfaceIndex> lineIndex_, creaseIndex_, cornerIndex_;
};

} // namespace i2b
