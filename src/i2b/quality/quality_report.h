// Quality of a PolyMesh in OpenFOAM's own measures, to the letter (checkMesh -allTopology -allGeometry).
#pragma once
#include "i2b/assemble/poly_mesh.h"
#include <cstdint>
#include <string>
#include <vector>

namespace i2b {

// checkMesh's defaults.
struct QualityLimits {
    double nonOrthogonality = 70;    // degrees; over it a face is "severely non-orthogonal"
    double skewness = 4;             // of internal and boundary faces alike (checkMesh)
    double aspectRatio = 1000;
    double closedness = 1e-6;
    double concavity = 10;           // degrees, of a face's angles
    double flatness = 0.8;
    double determinant = 0.001;
    double faceWeight = 0.05;
    double volumeRatio = 0.01;
    double smallVolume = 1e-300;     // m^3
    double faceArea = 1e-300;        // m^2
    double edgeAlignment = 1e-6;
};

// One named check: how many faces, cells or points fail it, and the worst place.
struct QualityCheck {
    std::string name;                // as checkMesh names the set it writes, e.g. "nonOrthoFaces"
    std::int64_t count = 0;
    bool fails = false;              // checkMesh counts it as a failed mesh check (some checks only warn)
    Vec3 worst;                      // m
    std::vector<std::int32_t> ids;   // of the failing faces, cells or points, ascending (at most 1000)
};

struct QualityReport {
    std::int64_t cells = 0, faces = 0, internalFaces = 0, points = 0;
    std::int64_t negativeVolumeCells = 0;
    std::int64_t wrongOrientedFaces = 0;      // face pyramids of negative volume
    std::int64_t openCells = 0;
    std::int64_t severeNonOrthogonalFaces = 0, highlySkewFaces = 0, concaveCells = 0;
    std::int64_t smallDeterminantCells = 0, lowWeightFaces = 0, lowVolumeRatioFaces = 0;
    double maxNonOrthogonality = 0, meanNonOrthogonality = 0; // degrees
    double maxSkewness = 0, maxAspectRatio = 0, maxOpenness = 0;
    double minVolume = 0, maxVolume = 0, totalVolume = 0;     // m^3
    double minFaceArea = 0, maxFaceArea = 0;                  // m^2
    double minFaceWeight = 0, meanFaceWeight = 0, minVolumeRatio = 0, meanVolumeRatio = 0;
    double minDeterminant = 0, meanDeterminant = 0, minFaceFlatness = 0, meanFaceFlatness = 0;
    std::vector<QualityCheck> checks;         // in checkMesh's order, those with a count only
    int failedChecks = 0;                     // checkMesh's "Failed n mesh checks."
    bool ok() const { return failedChecks == 0; }
};

QualityReport measureQuality(const PolyMesh& mesh, const QualityLimits& limits = {});

} // namespace i2b
