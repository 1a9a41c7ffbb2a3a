// Quality of a PolyMesh in the measures OpenFOAM users know: what checkMesh -allTopology -allGeometry reports.
#pragma once
#include "i2b/assemble/poly_mesh.h"
#include "i2b/quality/dictionary_limits.h"
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
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
    double boundarySkewness = 1e300; // of boundary faces, where it is less: asked for by the repair, no check of checkMesh's,
    double pyramidVolume = 0;        // m^3, as is this, of a face with a cell's centre,
    double tetQuality = 0;           // and this, of the tetrahedra of faces with centres of cells; 0: any
    double faceArea = 1e-300;        // m^2
    double edgeAlignment = 1e-6;
};

// What is beyond a limit of the dictionary.
struct DictionaryCheck {
    std::string key;                 // in the dictionary, e.g. "maxNonOrtho"
    double limit = 0;
    bool asked = true;
    std::int64_t faces = 0;          // beyond it, or of cells beyond it
    std::int64_t newFaces = 0;       // of these, the ones that are within all limits listed before: what checkMesh prints
    std::int64_t cells = 0;          // beyond a limit of cells
    Vec3 worst;                      // m, where any are
};

// One named check: how many faces, cells or points fail it, and the worst place.
struct QualityCheck {
    std::string name;                // as checkMesh names the set it writes, e.g. "nonOrthoFaces"
    std::int64_t count = 0;
    bool fails = false;              // checkMesh counts it as a failed mesh check (some checks only warn)
    Vec3 worst;                      // m
    std::vector<std::int32_t> ids;   // of the failing faces, cells or points, ascending (at most 1000)
};

enum class SurfaceTopology { empty, closed, sharedPoint, open, sharedEdge };

// One patch as a surface of its own.
struct PatchQuality {
    std::string name;
    std::int64_t faces = 0, points = 0;
    SurfaceTopology topology = SurfaceTopology::empty;
    Box box;                         // m
};

struct ZoneQuality {
    std::string name;
    std::int64_t cells = 0, points = 0;
    double volume = 0;               // m^3
    Box box;                         // m
};

// Cells that are connected through faces; numbered by their first cell.
struct RegionQuality {
    std::int64_t cells = 0;
    bool pointConnected = false;     // shares a boundary point with another region
};

// How many cells of each shape: it follows from the sizes of a cell's faces, as checkMesh sees it.
struct CellShapes {
    std::int64_t hexahedra = 0, prisms = 0, wedges = 0, pyramids = 0, tetWedges = 0, tetrahedra = 0, polyhedra = 0;
};

// What a mesh is made of.
struct MeshStatistics : CellShapes {
    std::int64_t internalPoints = -1; // used by no boundary face; -1 unless these points come first
    std::int64_t edges = 0, internalEdges = 0, internalEdgesOnePoint = 0, internalEdgesTwoPoints = 0; // if not -1
    std::vector<std::pair<std::int64_t, std::int64_t>> polyhedraByFaces; // faces, cells; ascending
};

struct WedgeQuality {
    std::string name;
    double angle = 0;                // degrees
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
    MeshStatistics statistics;
    std::vector<PatchQuality> patches;
    std::vector<ZoneQuality> zones;
    std::vector<RegionQuality> regions;
    std::vector<WedgeQuality> wedges;
    Box box;                                  // m, of all points
    std::array<int, 3> geometricDirections{1, 1, 1}, solutionDirections{1, 1, 1}; // 0: empty or wedge
    bool boundaryDefined = true;              // patches follow each other and have different names
    bool emptyFacesDivide = true;             // faces on empty patches are a multiple of the cells
    bool upperTriangular = true;
    std::int64_t multiplyConnectedCells = 0;  // with more than one face to the same neighbour
    std::int64_t unusedPoints = 0, faultyFaceVertices = 0, openCellsByEdges = 0;
    std::int64_t baffleFaces = 0, duplicateFaces = 0, nonConsecutiveFaces = 0;
    std::int64_t misalignedEdges = 0;         // in meshes with an empty direction
    Vec3 boundaryOpenness;                    // area sum over area, per axis
    std::int64_t highAspectRatioCells = 0, nonOrthogonalityErrors = 0;
    std::int64_t tetErrors = 0;               // faces whose decomposition into tetrahedra is poor (sides counted)
    double minEdgeLength = 0, maxEdgeLength = 0, nearDistance = 0; // m
    std::int64_t shortEdgePoints = 0, concaveFaces = 0, warpedFaces = 0, flatnessFaces = 0;
    double maxConcaveAngle = 0;               // degrees
    std::vector<DictionaryCheck> dictionary;  // in the order of checkMesh -meshQuality
    std::int64_t dictionaryFaces = 0;         // beyond any of its limits
    std::vector<std::int32_t> dictionaryIds;  // the first of these, ascending, as many as a Tally keeps
    double minFullness = 0;                   // least determinant by all faces, the dictionary's
    QualityLimits limits;                     // those it was measured with
    DictionaryLimits dictionaryLimits;
    std::vector<QualityCheck> checks;         // in checkMesh's order, those with a count only
    int failedChecks = 0;                     // checkMesh's "Failed n mesh checks."
    bool ok() const { return failedChecks == 0; }
};

struct CellFigures;

// Definitions and tolerances are those of OpenFOAM v1912, and sums run in the order of the mesh, so that figures agree
// with checkMesh's to the last digit printed. Coupled patches (cyclic, processor) are taken as plain boundary. Needs valid indices (what
// PolyMesh::validate() says about ranges); anything else may be wrong with the mesh. Deterministic on any number of threads.
// What was worked out about single cells goes to `left` (cell_quality.h), where there is one.
QualityReport measureQuality(const PolyMesh& mesh, const QualityLimits& limits = {}, const DictionaryLimits& dictionary = {}, CellFigures* left = nullptr);

// The report as text: what the mesh is made of, its patches, zones and regions, then a table of all checks (worst
// and mean value, limit, how many are beyond it, verdict, place of the worst) in three groups, and in the last line
// "all checks pass" or "N of M checks fail". Extended are those that checkMesh makes with -allTopology and
// -allGeometry only. digits: significant ones.
std::string formatQuality(const QualityReport& report, int digits = 6);

// The named check, or null where nothing fails it.
const QualityCheck* findCheck(const QualityReport& report, std::string_view name);

} // namespace i2b
