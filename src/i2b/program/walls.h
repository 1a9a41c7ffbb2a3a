// From the kept cells to a valid mesh: front, fit, layers, assembly and repair.
#pragma once
#include "i2b/core/context.h"
#include "i2b/fit/fit.h"
#include "i2b/front/front.h"
#include "i2b/layers/lay_on.h"
#include "i2b/program/generate.h"
#include "i2b/program/limits_in_reach.h"
#include "i2b/repair/repair.h"

namespace i2b {

struct WallInput {
    const GridResult& cartesian;
    const LatticeMesh& lattice;     // of cartesian.kept
    const FeatureGraph& features;
    const WallPlans& plans;
    const FitOptions& fit;
    const DictionaryLimits& limits; // of faces, asked for,
    const DictionaryLimits& fallback; // and those taken where these are out of reach
};

struct Walls {
    Front front;                    // as in the mesh
    FitSummary fitted;
    LaidLayers laid;
    RepairSummary repaired;         // movedWalls: by layers, too
    LimitsInReach reach;            // what the mesh was repaired to
};

// mesh: with them; no cell of negative volume and no face of wrong orientation, or an Error of kind internal. Where cells cannot be made
// valid all is done again with the faces around them uncut, in the last try with all faces so: what is left then is the
// smooth front, which is right at its start.
Walls makeWalls(const WallInput& in, PolyMesh& mesh, Context& context);

} // namespace i2b
