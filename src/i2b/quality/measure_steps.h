// The steps of measureQuality. Each fills its part of the report and of the tallies; measure.cpp puts them in
// order.
#pragma once
#include "i2b/quality/cell_quality.h"
#include "i2b/quality/mesh_geometry.h"
#include "i2b/quality/quality_report.h"
#include "i2b/quality/tally.h"
#include <map>

namespace i2b {

// Of what fails a check, under the names of checkMesh's sets, in its order.
struct QualityTallies {
    Tally illegalCells, unusedPoints, upperTriangularFace, outOfRangeFaces, zipUpCells, edgeFaces;
    Tally oneInternalFaceCells, twoInternalFacesCells, multiRegionPoints, nonManifoldPoints;
    Tally nonAlignedEdges, nonClosedCells, highAspectRatioCells, zeroAreaFaces, zeroVolumeCells,
        nonOrthoFaces;
    Tally wrongOrientedFaces, skewFaces, lowQualityTetFaces, shortEdges, nearPoints, concaveFaces,
        warpedFaces;
    Tally underdeterminedCells, concaveCells, lowWeightFaces, lowVolRatioFaces;
};

struct Measurement {
    const PolyMesh& mesh;
    const QualityLimits& limits;
    const DictionaryLimits& dictionary;
    Rows cellFaces;
    RawVector<CellMoments> moments; // per cell; given up when faces have been measured
    QualityTallies tallies;
    QualityReport report;
    std::vector<std::uint8_t> shortPoints; // per point: 1 at the end of a short edge
    Tally hollowCells;                     // under the dictionary's limit of determinants
    std::vector<std::int32_t> hollowFaces; // theirs, with repetitions
    // Per cell and per face 1: of the cell only its moments count, of the face nothing; empty: all are measured.
    std::vector<std::uint8_t> outerCells{}, outerFaces{};
    std::map<std::int32_t, Vec3> worstCells{}; // centres, m, of those that checks name
    CellQualityMaker* shown = nullptr; // takes what measureFaces() finds, of each cell
};

// Of single cells: moments, closedness, aspect ratio, determinant, concavity, shape, edge
// use.
void measureCells(Measurement& m);
// Of faces: areas, flatness, angles, repeated vertices, edge lengths; with the cells at their sides: orthogonality,
// pyramids, skewness, weights, volume ratio, tetrahedra. Needs moments.
void measureFaces(Measurement& m);

void measureDirections(Measurement& m); // empty and wedge patches
void measureAlignment(Measurement& m);  // of edges, where a direction is empty; needs the directions
void measurePoints(Measurement& m);     // unused, internal ones; edges
void measureFaceFaces(Measurement& m);  // pairs that share points oddly
void measureNearPoints(Measurement& m); // after measureFaces
void measureRegions(Measurement& m);
void measurePatches(Measurement& m);
void measureZones(Measurement& m); // needs moments

// 1.0e-6 of the diagonal, squared: closer points are near, shorter edges are short.
double nearDistanceSquared(const Box& box);

// tally of the marked items
Tally tallyMarks(const std::vector<std::uint8_t>& marks);

} // namespace i2b
