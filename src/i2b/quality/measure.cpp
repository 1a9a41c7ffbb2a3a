#include "i2b/core/give_up.h"
#include "i2b/quality/measure_steps.h"
#include <algorithm>
#include <optional>

namespace i2b {
namespace {

using Index = std::size_t;

enum class Kind { cells, faces, points };

Vec3 place(const Measurement& m, Kind kind, std::int32_t id) {
    const auto i = static_cast<Index>(id);
    return kind == Kind::cells   ? m.worstCells.at(id)
           : kind == Kind::faces ? measureFace(m.mesh, id).centre
                                 : m.mesh.points[i];
}

// Of the cells only the centres that listChecks() shows stay.
void giveUpMoments(Measurement& m) {
    const QualityTallies& t = m.tallies;
    for (const Tally* tally : {&t.illegalCells, &t.zipUpCells, &t.oneInternalFaceCells, &t.twoInternalFacesCells, &t.nonClosedCells, &t.highAspectRatioCells,
                               &t.zeroVolumeCells, &t.underdeterminedCells, &t.concaveCells}) {
        if (tally->count > 0) m.worstCells[tally->worstId] = m.moments[static_cast<Index>(tally->worstId)].centre;
    }
    giveUp(m.moments);
}

// In the order of checkMesh's sets. Openness and aspect ratio are one check: open cells leave no word on
// ratios.
void listChecks(Measurement& m) {
    QualityReport& r = m.report;
    QualityTallies& t = m.tallies;
    const auto add = [&](const char* name, Kind kind, Tally& tally, bool fails) {
        if (fails) ++r.failedChecks;
        if (tally.count == 0) return;
        r.checks.push_back({name, tally.count, fails, place(m, kind, tally.worstId), std::move(tally.ids)});
    };
    const auto failing = [](const Tally& tally) { return tally.count > 0; };
    add("illegalCells", Kind::cells, t.illegalCells, failing(t.illegalCells));
    add("unusedPoints", Kind::points, t.unusedPoints, failing(t.unusedPoints));
    add("upperTriangularFace", Kind::faces, t.upperTriangularFace, !r.upperTriangular);
    add("outOfRangeFaces", Kind::faces, t.outOfRangeFaces, failing(t.outOfRangeFaces));
    if (r.openCellsByEdges > 0) add("zipUpCells", Kind::cells, t.zipUpCells, true);
    add("edgeFaces", Kind::faces, t.edgeFaces, false);
    add("oneInternalFaceCells", Kind::cells, t.oneInternalFaceCells, false);
    add("twoInternalFacesCells", Kind::cells, t.twoInternalFacesCells, false);
    add("multiRegionPoints", Kind::points, t.multiRegionPoints, false);
    add("nonManifoldPoints", Kind::points, t.nonManifoldPoints, false);
    add("nonAlignedEdges", Kind::points, t.nonAlignedEdges, failing(t.nonAlignedEdges));
    const Vec3& open = r.boundaryOpenness;
    if (std::max({std::abs(open.x), std::abs(open.y), std::abs(open.z)}) > m.limits.closedness)
        ++r.failedChecks;
    add("nonClosedCells", Kind::cells, t.nonClosedCells, failing(t.nonClosedCells));
    add("highAspectRatioCells", Kind::cells, t.highAspectRatioCells,
        r.openCells == 0 && r.highAspectRatioCells > 0);
    add("zeroAreaFaces", Kind::faces, t.zeroAreaFaces, failing(t.zeroAreaFaces));
    add("zeroVolumeCells", Kind::cells, t.zeroVolumeCells, failing(t.zeroVolumeCells));
    add("nonOrthoFaces", Kind::faces, t.nonOrthoFaces, r.nonOrthogonalityErrors > 0);
    add("wrongOrientedFaces", Kind::faces, t.wrongOrientedFaces, failing(t.wrongOrientedFaces));
    add("skewFaces", Kind::faces, t.skewFaces, failing(t.skewFaces));
    add("lowQualityTetFaces", Kind::faces, t.lowQualityTetFaces, failing(t.lowQualityTetFaces));
    add("shortEdges", Kind::points, t.shortEdges, false);
    add("nearPoints", Kind::points, t.nearPoints, false);
    add("concaveFaces", Kind::faces, t.concaveFaces, false);
    add("warpedFaces", Kind::faces, t.warpedFaces, false);
    add("underdeterminedCells", Kind::cells, t.underdeterminedCells, failing(t.underdeterminedCells));
    add("concaveCells", Kind::cells, t.concaveCells, failing(t.concaveCells));
    add("lowWeightFaces", Kind::faces, t.lowWeightFaces, failing(t.lowWeightFaces));
    add("lowVolRatioFaces", Kind::faces, t.lowVolRatioFaces, failing(t.lowVolRatioFaces));
}

Box pointBox(std::span<const Vec3> points) {
    return orderedReduce(
        points.size(), Box{},
        [&](Index begin, Index end) {
            Box box;
            for (Index i = begin; i < end; ++i) box.add(points[i]);
            return box;
        },
        [](Box a, const Box& b) {
            a.add(b);
            return a;
        });
}

} // namespace

QualityReport measureQuality(const PolyMesh& mesh, const QualityLimits& limits, const DictionaryLimits& dictionary, CellFigures* left) {
    Measurement m{mesh, limits, dictionary, {}, {}, {}, {}, {}, {}, {}};
    m.report.limits = limits;
    m.report.cells = mesh.cells;
    m.report.faces = mesh.faces();
    m.report.internalFaces = mesh.internalFaces();
    m.report.points = static_cast<std::int64_t>(mesh.points.size());
    m.report.box = pointBox(mesh.points);
    measureDirections(m);
    measureAlignment(m);
    measurePoints(m);
    measureFaceFaces(m);
    m.cellFaces = buildCellFaces(mesh);
    measureCells(m);
    measureZones(m);
    if (left) left->faces = std::move(m.cellFaces);
    m.cellFaces = {};
    std::optional<CellQualityMaker> shown;
    if (left && left->wantsQuality) m.shown = &shown.emplace(m.moments);
    measureFaces(m);
    if (shown) left->quality = shown->take();
    giveUpMoments(m);
    measureRegions(m);
    measurePatches(m);
    measureNearPoints(m);
    listChecks(m);
    return std::move(m.report);
}

const QualityCheck* findCheck(const QualityReport& report, std::string_view name) {
    const auto found = std::find_if(report.checks.begin(), report.checks.end(),
                                    [&](const QualityCheck& c) { return c.name == name; });
    return found == report.checks.end() ? nullptr : &*found;
}

} // namespace i2b
