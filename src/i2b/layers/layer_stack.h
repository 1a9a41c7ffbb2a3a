// How the single layer of prisms between front and wall is subdivided.
#pragma once
#include "i2b/front/front.h"
#include "i2b/options.h"
#include <cstdint>
#include <string>
#include <vector>

namespace i2b {

struct LayerStack {
    int count = 0;                       // prism cells per front face, 1 or more
    std::vector<float> fractions;        // per front vertex, count each: position along front -> wall of the outer
                                         // surface of layer k = 0 (next to the front) ... ; the last is 1 (the wall)
    double requested = 0;                // layers asked for
    double facesCovered = 0;             // fraction of wall faces that carry all of them
    double meanCount = 0;                // layers per wall face
    double thicknessFraction = 0;        // achieved over asked total thickness, mean over wall faces
    double meanFirstHeight = 0;          // m, at the wall

    float fraction(std::size_t vertex, int k) const { return fractions[vertex * static_cast<std::size_t>(count) + static_cast<std::size_t>(k)]; }
    std::string validate() const;        // "" or: fractions not rising to 1
};

// Heights fall towards the wall by the growth ratio. With a first-layer height the ratio of each stack is solved for,
// so that the height at the wall is met and the stack fills the room between front and wall.
LayerStack makeLayers(const Front& front, const LayerOptions& options);

} // namespace i2b
