#include "i2b/quality/quality_report.h"
#include <fmt/format.h>
#include <iterator>

namespace i2b {
namespace {

std::string directions(const std::array<int, 3>& d) { return fmt::format("({} {} {})", d[0], d[1], d[2]); }
int sum(const std::array<int, 3>& d) { return d[0] + d[1] + d[2]; }

class Text {
  public:
    Text(const QualityReport& report, int digits) : r_(report), digits_(digits) {}

    // As a C++ stream prints with that many significant digits.
    std::string num(double v) const { return fmt::format("{:.{}g}", v, digits_); }
    std::string vec(const Vec3& v) const { return fmt::format("({} {} {})", num(v.x), num(v.y), num(v.z)); }
    std::string box(const Box& b) const { return vec(b.lo) + " " + vec(b.hi); }

    template <class... Args>
    void line(fmt::format_string<Args...> format, Args&&... args) {
        fmt::format_to(std::back_inserter(text_), format, std::forward<Args>(args)...);
        text_ += '\n';
    }
    // what: "faces with ..."; nothing where the set is empty
    void set(const char* name, const char* what) {
        if (const QualityCheck* check = findCheck(r_, name))
            line("  <<Writing {} {} to set {}", check->count, what, name);
    }
    std::string take() { return std::move(text_); }

  private:
    const QualityReport& r_;
    int digits_;
    std::string text_;
};

void statistics(Text& t, const QualityReport& r) {
    const MeshStatistics& s = r.statistics;
    t.line("Mesh stats");
    t.line("    points:           {}", r.points);
    if (s.internalPoints >= 0) {
        t.line("    internal points:  {}", s.internalPoints);
        t.line("    edges:            {}", s.edges);
        t.line("    internal edges:   {}", s.internalEdges);
        t.line("    internal edges using one boundary point:   {}", s.internalEdgesOnePoint);
        t.line("    internal edges using two boundary points:  {}", s.internalEdgesTwoPoints);
    }
    t.line("    faces:            {}", r.faces);
    t.line("    internal faces:   {}", r.internalFaces);
    t.line("    cells:            {}", r.cells);
    t.line("    faces per cell:   {}",
           t.num(double(r.faces + r.internalFaces) / double(std::max<std::int64_t>(1, r.cells))));
    t.line("    boundary patches: {}", r.patches.size());
    t.line("    point zones:      0\n    face zones:       0");
    t.line("    cell zones:       {}\n", r.zones.size());
    t.line("Overall number of cells of each type:");
    t.line("    hexahedra:     {}\n    prisms:        {}\n    wedges:        {}", s.hexahedra, s.prisms,
           s.wedges);
    t.line("    pyramids:      {}\n    tet wedges:    {}", s.pyramids, s.tetWedges);
    t.line("    tetrahedra:    {}\n    polyhedra:     {}", s.tetrahedra, s.polyhedra);
    if (s.polyhedra > 0) {
        t.line("    Breakdown of polyhedra by number of faces:\n        faces   number of cells");
        for (const auto& [faces, cells] : s.polyhedraByFaces) t.line("{:>13}   {}", faces, cells);
    }
    t.line("");
}

void regions(Text& t, const QualityReport& r) {
    if (r.regions.size() <= 1) {
        t.line("    Number of regions: {} (OK).", r.regions.size());
        return;
    }
    t.line("   *Number of regions: {}", r.regions.size());
    t.line("    The mesh has multiple regions which are not connected by any face.");
    for (std::size_t i = 0; i < r.regions.size(); ++i)
        t.line("  <<Writing region {} ({}) with {} cells to cellSet region{}", i,
               r.regions[i].pointConnected ? "point connected" : "fully disconnected",
               t.num(double(r.regions[i].cells)), i);
    t.set("multiRegionPoints", "points that are in multiple regions");
}

void topology(Text& t, const QualityReport& r) {
    t.line("Checking topology...");
    t.line("{}", r.boundaryDefined ? "    Boundary definition OK." : " ***Boundary definition is in error.");
    if (!r.emptyFacesDivide)
        t.line(
            " ***Total number of faces on empty patches is not divisible by the number of cells in the mesh."
            " Hence this mesh is not 1D or 2D.");
    if (const QualityCheck* illegal = findCheck(r, "illegalCells"))
        t.line("    Illegal cells (less than 4 faces or out of range faces) found,  number of cells: {}",
               illegal->count);
    else
        t.line("    Cell to face addressing OK.");
    t.set("illegalCells", "illegal cells");
    if (r.unusedPoints > 0)
        t.line(" ***Unused points found in the mesh, number unused by faces: {} number unused by cells: {}",
               r.unusedPoints, r.unusedPoints);
    else
        t.line("    Point usage OK.");
    t.set("unusedPoints", "unused points");
    if (r.multiplyConnectedCells > 0)
        t.line("  <<Found {} neighbouring cells with multiple inbetween faces.", r.multiplyConnectedCells);
    t.line("{}", r.upperTriangular ? "    Upper triangular ordering OK."
                                   : " ***Faces not in upper triangular order.");
    t.set("upperTriangularFace", "unordered faces");
    if (r.faultyFaceVertices > 0)
        t.line("    Faces with invalid vertex labels found,  number of faces: {}", r.faultyFaceVertices);
    else
        t.line("    Face vertices OK.");
    t.set("outOfRangeFaces", "faces with out-of-range or duplicate vertices");
    if (r.openCellsByEdges > 0)
        t.line(" ***Open cells found, number of cells: {}. This problem may be fixable using the zipUpMesh "
               "utility.",
               r.openCellsByEdges);
    else
        t.line("    Topological cell zip-up check OK.");
    t.set("zipUpCells", "cells with over used edges");
    if (r.baffleFaces > 0)
        t.line("    Number of identical duplicate faces (baffle faces): {}", r.baffleFaces);
    if (r.duplicateFaces > 0)
        t.line("  <<Number of duplicate (not baffle) faces found: {}. This might indicate a problem.",
               r.duplicateFaces);
    if (r.nonConsecutiveFaces > 0)
        t.line("  <<Number of faces with non-consecutive shared points: {}. This might indicate a problem.",
               r.nonConsecutiveFaces);
    if (r.duplicateFaces == 0 && r.nonConsecutiveFaces == 0) t.line("    Face-face connectivity OK.");
    t.set("edgeFaces", "faces with non-standard edge connectivity");
    t.set("oneInternalFaceCells", "cells with zero or one non-boundary face");
    t.set("twoInternalFacesCells", "cells with two non-boundary faces");
    regions(t, r);
}

const char* topologyText(SurfaceTopology topology) {
    switch (topology) {
    case SurfaceTopology::empty:
        return "ok (empty)";
    case SurfaceTopology::closed:
        return "ok (closed singly connected)";
    case SurfaceTopology::sharedPoint:
        return "multiply connected (shared point)";
    case SurfaceTopology::open:
        return "ok (non-closed singly connected)";
    case SurfaceTopology::sharedEdge:
        return "multiply connected (shared edge)";
    }
    return "";
}

void surfaces(Text& t, const QualityReport& r) {
    t.line("\nChecking patch topology for multiply connected surfaces...");
    t.line("    {:<20}{:<9}{:<9}{:<34} Bounding box", "Patch", "Faces", "Points", "Surface topology");
    for (const PatchQuality& p : r.patches)
        t.line("    {:<20}{:<9}{:<9}{:<34}{}", p.name, p.faces, p.points, topologyText(p.topology),
               p.points > 0 ? " " + t.box(p.box) : "");
    t.line("\nChecking faceZone topology for multiply connected surfaces...\n    No faceZones found.");
    t.set("nonManifoldPoints", "conflicting points");
    t.line("\nChecking basic cellZone addressing...");
    if (r.zones.empty())
        t.line("    No cellZones found.");
    else
        t.line("    {:<20}{:<13}{:<13}{:<13}BoundingBox", "CellZone", "Cells", "Points", "Volume");
    for (const ZoneQuality& z : r.zones)
        t.line("    {:<19} {:<12} {:<12} {:<12} {}", z.name, z.cells, z.points, t.num(z.volume),
               t.box(z.box));
}

void alignment(Text& t, const QualityReport& r) {
    t.line("    Mesh has {} geometric (non-empty/wedge) directions {}", sum(r.geometricDirections),
           directions(r.geometricDirections));
    t.line("    Mesh has {} solution (non-empty) directions {}", sum(r.solutionDirections),
           directions(r.solutionDirections));
    if (sum(r.geometricDirections) == 3) return;
    for (const WedgeQuality& w : r.wedges)
        t.line("    Wedge {} with angle {} degrees", w.name, t.num(w.angle));
    if (r.misalignedEdges > 0)
        t.line(" ***Number of edges not aligned with or perpendicular to non-empty directions: {}",
               r.misalignedEdges);
    else
        t.line("    All edges aligned with or perpendicular to non-empty directions.");
    t.set("nonAlignedEdges", "points on non-aligned edges");
}

void closedness(Text& t, const QualityReport& r) {
    const Vec3& o = r.boundaryOpenness;
    if (std::max({std::abs(o.x), std::abs(o.y), std::abs(o.z)}) > r.limits.closedness)
        t.line(" ***Boundary openness {} possible hole in boundary description.", t.vec(o));
    else
        t.line("    Boundary openness {} OK.", t.vec(o));
    if (r.openCells > 0) {
        t.line(" ***Open cells found, max cell openness: {}, number of open cells {}", t.num(r.maxOpenness),
               r.openCells);
    } else if (r.highAspectRatioCells > 0) {
        t.line(" ***High aspect ratio cells found, Max aspect ratio: {}, number of cells {}",
               t.num(r.maxAspectRatio), r.highAspectRatioCells);
    } else {
        t.line("    Max cell openness = {} OK.", t.num(r.maxOpenness));
        t.line("    Max aspect ratio = {} OK.", t.num(r.maxAspectRatio));
    }
    t.set("nonClosedCells", "non closed cells");
    t.set("highAspectRatioCells", "cells with high aspect ratio");
}

void sizes(Text& t, const QualityReport& r) {
    if (findCheck(r, "zeroAreaFaces") != nullptr)
        t.line(" ***Zero or negative face area detected.  Minimum area: {}", t.num(r.minFaceArea));
    else
        t.line("    Minimum face area = {}. Maximum face area = {}.  Face area magnitudes OK.",
               t.num(r.minFaceArea), t.num(r.maxFaceArea));
    t.set("zeroAreaFaces", "zero area faces");
    if (r.negativeVolumeCells > 0)
        t.line(" ***Zero or negative cell volume detected.  Minimum negative volume: {}, Number of negative "
               "volume "
               "cells: {}",
               t.num(r.minVolume), r.negativeVolumeCells);
    else
        t.line("    Min volume = {}. Max volume = {}.  Total volume = {}.  Cell volumes OK.",
               t.num(r.minVolume), t.num(r.maxVolume), t.num(r.totalVolume));
    t.set("zeroVolumeCells", "zero volume cells");
}

void directionsOfFaces(Text& t, const QualityReport& r) {
    if (r.internalFaces > 0)
        t.line("    Mesh non-orthogonality Max: {} average: {}", t.num(r.maxNonOrthogonality),
               t.num(r.meanNonOrthogonality));
    if (r.severeNonOrthogonalFaces > 0)
        t.line("   *Number of severely non-orthogonal (> {} degrees) faces: {}.",
               t.num(r.limits.nonOrthogonality), r.severeNonOrthogonalFaces);
    if (r.nonOrthogonalityErrors > 0)
        t.line(" ***Number of non-orthogonality errors: {}.", r.nonOrthogonalityErrors);
    else
        t.line("    Non-orthogonality check OK.");
    t.set("nonOrthoFaces", "non-orthogonal faces");
    if (r.wrongOrientedFaces > 0)
        t.line(" ***Error in face pyramids: {} faces are incorrectly oriented.", r.wrongOrientedFaces);
    else
        t.line("    Face pyramids OK.");
    t.set("wrongOrientedFaces", "faces with incorrect orientation");
    if (r.highlySkewFaces > 0)
        t.line(" ***Max skewness = {}, {} highly skew faces detected which may impair the quality of the "
               "results",
               t.num(r.maxSkewness), r.highlySkewFaces);
    else
        t.line("    Max skewness = {} OK.", t.num(r.maxSkewness));
    t.set("skewFaces", "skew faces");
    t.line("    Coupled point location match (average 0) OK.");
}

void shapesOfFaces(Text& t, const QualityReport& r) {
    if (r.tetErrors > 0)
        t.line(" ***Error in face tets: {} faces with low quality or negative volume decomposition tets.",
               r.tetErrors);
    else
        t.line("    Face tets OK.");
    t.set("lowQualityTetFaces", "faces with low quality or negative volume decomposition tets");
    if (r.shortEdgePoints > 0)
        t.line("   *Edges too small, min/max edge length = {} {}, number too small: {}",
               t.num(r.minEdgeLength), t.num(r.maxEdgeLength), r.shortEdgePoints);
    else
        t.line("    Min/max edge length = {} {} OK.", t.num(r.minEdgeLength), t.num(r.maxEdgeLength));
    t.set("shortEdges", "points on short edges");
    if (const QualityCheck* near = findCheck(r, "nearPoints"))
        t.line("  <<Writing {} near (closer than {} apart) points to set nearPoints", near->count,
               t.num(r.nearDistance));
    if (r.concaveFaces > 0)
        t.line("   *There are {} faces with concave angles between consecutive edges. Max concave angle = {} "
               "degrees.",
               r.concaveFaces, t.num(r.maxConcaveAngle));
    else
        t.line("    All angles in faces OK.");
    t.set("concaveFaces", "faces with concave angles");
    if (r.flatnessFaces > 0)
        t.line("    Face flatness (1 = flat, 0 = butterfly) : min = {}  average = {}",
               t.num(r.minFaceFlatness), t.num(r.meanFaceFlatness));
    if (r.warpedFaces > 0) {
        t.line("   *There are {} faces with ratio between projected and actual area < {}", r.warpedFaces,
               t.num(r.limits.flatness));
        t.line("    Minimum ratio (minimum flatness, maximum warpage) = {}", t.num(r.minFaceFlatness));
    } else {
        t.line("    All face flatness OK.");
    }
    t.set("warpedFaces", "warped faces");
}

void cellsAndWeights(Text& t, const QualityReport& r) {
    if (r.cells > 0)
        t.line("    Cell determinant (wellposedness) : minimum: {} average: {}", t.num(r.minDeterminant),
               t.num(r.meanDeterminant));
    if (r.smallDeterminantCells > 0)
        t.line(" ***Cells with small determinant (< {}) found, number of cells: {}",
               t.num(r.limits.determinant), r.smallDeterminantCells);
    else
        t.line("    Cell determinant check OK.");
    t.set("underdeterminedCells", "under-determined cells");
    if (r.concaveCells > 0)
        t.line(" ***Concave cells (using face planes) found, number of cells: {}", r.concaveCells);
    else
        t.line("    Concave cell check OK.");
    t.set("concaveCells", "concave cells");
    if (r.internalFaces > 0)
        t.line("    Face interpolation weight : minimum: {} average: {}", t.num(r.minFaceWeight),
               t.num(r.meanFaceWeight));
    if (r.lowWeightFaces > 0)
        t.line(" ***Faces with small interpolation weight (< {}) found, number of faces: {}",
               t.num(r.limits.faceWeight), r.lowWeightFaces);
    else
        t.line("    Face interpolation weight check OK.");
    t.set("lowWeightFaces", "faces with low interpolation weights");
    if (r.internalFaces > 0)
        t.line("    Face volume ratio : minimum: {} average: {}", t.num(r.minVolumeRatio),
               t.num(r.meanVolumeRatio));
    if (r.lowVolumeRatioFaces > 0)
        t.line(" ***Faces with small volume ratio (< {}) found, number of faces: {}",
               t.num(r.limits.volumeRatio), r.lowVolumeRatioFaces);
    else
        t.line("    Face volume ratio check OK.");
    t.set("lowVolRatioFaces", "faces with low volume ratio cells");
}

} // namespace

std::string formatQuality(const QualityReport& report, int digits) {
    Text t(report, digits);
    statistics(t, report);
    topology(t, report);
    surfaces(t, report);
    t.line("\nChecking geometry...");
    t.line("    Overall domain bounding box {}", t.box(report.box));
    alignment(t, report);
    closedness(t, report);
    sizes(t, report);
    directionsOfFaces(t, report);
    shapesOfFaces(t, report);
    cellsAndWeights(t, report);
    if (report.ok())
        t.line("\nMesh OK.\n");
    else
        t.line("\nFailed {} mesh checks.\n", report.failedChecks);
    return t.take();
}

} // namespace i2b
