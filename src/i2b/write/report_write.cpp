#include "i2b/write/report_write.h"
#include "i2b/write/output_file.h"
#include <cmath>
#include <nlohmann/json.hpp>

namespace i2b {
namespace {

using Json = nlohmann::ordered_json;

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json place(const Vec3& p) { return Json::array({number(p.x), number(p.y), number(p.z)}); }

// Under the names of OpenFOAM's mesh quality dictionary.
Json limitsJson(const QualityReport& q) {
    Json limits = Json::object();
    for (const DictionaryCheck& check : q.dictionary) {
        Json& entry = limits[check.key] = {{"limit", number(check.limit)}, {"asked", check.asked}, {"faces", check.faces}};
        if (check.key == "minDeterminant") entry["cells"] = check.cells;
        if (check.faces > 0) entry["worst"] = place(check.worst);
    }
    return limits;
}

Json qualityJson(const QualityReport& q) {
    return {{"ok", q.ok()},
            {"negative_volume_cells", q.negativeVolumeCells},
            {"wrong_oriented_faces", q.wrongOrientedFaces},
            {"max_non_orthogonality", number(q.maxNonOrthogonality)},
            {"mean_non_orthogonality", number(q.meanNonOrthogonality)},
            {"max_skewness", number(q.maxSkewness)},
            {"max_aspect_ratio", number(q.maxAspectRatio)},
            {"min_face_weight", number(q.minFaceWeight)},
            {"min_volume_ratio", number(q.minVolumeRatio)},
            {"min_determinant", number(q.minDeterminant)},
            {"concave_cells", q.concaveCells},
            {"faces_beyond_limits", q.dictionaryFaces},
            {"limits", limitsJson(q)}};
}

Json fitJson(const FitReport& f) {
    return {{"wall_nodes_on_geometry_fraction", number(f.wallNodesOnGeometryFraction)},
            {"mean_distance_in_h", number(f.meanDistanceInH)},
            {"max_distance_in_h", number(f.maxDistanceInH)},
            {"feature_capture_fraction", number(f.featureCaptureFraction)},
            {"faint_capture_fraction", number(f.faintCaptureFraction)},
            {"faint_samples", f.faintSamples},
            {"tilted_face_fraction", number(f.tiltedFaceFraction)},
            {"tilted_45_face_fraction", number(f.tilted45FaceFraction)}};
}

Json changesJson(const MeshChanges& changes) {
    Json places = Json::array();
    for (const Vec3& p : changes.places) places.push_back(place(p));
    return {{"merged_cells", changes.merged}, {"divided_faces", changes.divided}, {"joined_rim_nodes", changes.joined}, {"places", places}};
}

Json layerRowJson(const LayerRow& row) {
    Json shorter;
    for (std::size_t c = 1; c < layerCauseNames.size(); ++c) shorter[layerCauseNames[c]] = row.causes[c];
    return {{"name", row.part},
            {"requested", row.asked},
            {"requested_first_height", number(row.askedFirst)},
            {"requested_thickness", number(row.askedThickness)},
            {"mean_count", number(row.meanCount)},
            {"mean_first_height", number(row.meanFirst)},
            {"mean_thickness", number(row.meanThickness)},
            {"faces", row.faces},
            {"faces_short", shorter}};
}

Json offPlaceJson(const OffPlace& p) {
    return {{"nodes", p.nodes},
            {"cause", nameOf(p.cause)},
            {"part", p.part},
            {"centre", place(p.centre)},
            {"box", Json::array({place(p.box.lo), place(p.box.hi)})},
            {"max_distance_in_h", number(p.farthestInH)},
            {"farthest", place(p.farthest)}};
}

Json offPlacesJson(const OffPlaces& places) {
    Json list = Json::array();
    for (const OffPlace& p : places.first) list.push_back(offPlaceJson(p));
    return list;
}

Json offGeometryJson(const OffGeometry& off) {
    Json causes = Json::object();
    for (std::size_t i = 1; i < static_cast<std::size_t>(OffCause::tilted); ++i) causes[nameOf(static_cast<OffCause>(i))] = off.counts[i];
    return {{"nodes", off.nodes},
            {"fraction", number(off.fraction)},
            {"causes", causes},
            {"places_total", off.places.total},
            {"places", offPlacesJson(off.places)},
            {"tilted_nodes", off.tilted},
            {"tilted_places_total", off.tiltedPlaces.total},
            {"tilted_places", offPlacesJson(off.tiltedPlaces)}};
}

Json lostEdgesJson(const LostEdges& lost) {
    Json places = Json::array();
    for (const LostEdge& e : lost.first)
        places.push_back({{"length", number(e.length)}, {"part", e.part}, {"cause", nameOf(e.cause)}, {"at", place(e.at)}, {"box", Json::array({place(e.box.lo), place(e.box.hi)})}});
    Json lengths;
    for (std::size_t i = 0; i < lostCauses; ++i) lengths[nameOf(static_cast<LostCause>(i))] = number(lost.lengthOf[i]);
    return {{"length", number(lost.length())}, {"length_by_cause", lengths}, {"places_total", lost.total}, {"places", places}};
}

Json layersJson(const LayerReport& l) {
    Json parts = Json::array();
    for (const LayerRow& row : l.parts) parts.push_back(layerRowJson(row));
    return {{"requested", l.requested},
            {"mean_count", number(l.meanCount)},
            {"faces_covered_fraction", number(l.facesCoveredFraction)},
            {"thickness_fraction", number(l.thicknessFraction)},
            {"mean_first_height", number(l.meanFirst)},
            {"min_first_height", number(l.minFirst)},
            {"max_first_height", number(l.maxFirst)},
            {"parts", parts}};
}

Json regionJson(const Region& r, const std::vector<ReportPart>& parts) {
    Json touched = Json::array();
    for (const std::int32_t part : r.parts) {
        const auto i = static_cast<std::size_t>(part);
        touched.push_back(part >= 0 && i < parts.size() ? Json(parts[i].name) : Json(part));
    }
    return {{"id", r.id},
            {"name", r.name},
            {"cells", r.cells},
            {"volume", number(r.volume)},
            {"box", Json::array({place(r.box.lo), place(r.box.hi)})},
            {"touches_domain_box", r.touchesDomainBox},
            {"painted", r.painted},
            {"parts", touched},
            {"seed", place(r.seed)}};
}

} // namespace

std::string reportText(const RunReport& r) {
    Json parts = Json::array(), stages = Json::array(), patches = Json::array(), regions = Json::array(),
         leaks = Json::array();
    for (const ReportPart& part : r.parts)
        parts.push_back({{"name", part.name}, {"triangles", part.triangles}});
    for (const StageRecord& s : r.stages)
        stages.push_back({{"name", s.name},
                          {"seconds", number(s.seconds)},
                          {"items", s.items},
                          {"rss_bytes", s.rssBytes},
                          {"peak_rss_bytes", s.peakRssBytes}});
    for (const Patch& p : r.patches)
        patches.push_back({{"name", p.name}, {"type", p.type}, {"faces", p.count}});
    for (const Region& region : r.regions) regions.push_back(regionJson(region, r.parts));
    for (const Leak& leak : r.leaks)
        leaks.push_back({{"place", place(leak.place)},
                         {"width", number(leak.width)},
                         {"area", number(leak.area)},
                         {"box", Json::array({place(leak.box.lo), place(leak.box.hi)})},
                         {"text", leak.text}});

    Json json;
    json["program"] = {{"name", r.programName}, {"version", r.programVersion}};
    json["geometry"] = {{"files", r.files}, {"triangles", r.triangles}, {"parts", parts}};
    json["threads"] = r.threads;
    json["sizes"] = {{"surface", number(r.surfaceSize)},
                     {"min", number(r.minSize)},
                     {"max", number(r.maxSize)},
                     {"levels", r.levels}};
    json["seconds"] = number(r.seconds);
    json["peak_rss_bytes"] = r.peakRssBytes;
    json["stages"] = stages;
    json["cells"] = r.cells;
    json["faces"] = r.faces;
    json["points"] = r.points;
    json["wall_faces"] = r.wallFaces;
    json["quality"] = r.quality ? qualityJson(*r.quality) : Json(nullptr);
    if (r.quality) json["quality"]["changes"] = changesJson(r.changes);
    json["fit"] = r.fit ? fitJson(*r.fit) : Json(nullptr);
    if (r.fit) json["fit"]["cut_short"] = r.fitCutShort;
    if (r.fit) json["fit"]["lost_edges"] = lostEdgesJson(r.fit->lostEdges);
    if (r.fit) json["fit"]["off_geometry"] = r.offGeometry ? offGeometryJson(*r.offGeometry) : Json(nullptr);
    json["layers"] = r.layers ? layersJson(*r.layers) : Json(nullptr);
    json["patches"] = patches;
    json["regions"] = regions;
    json["leaks"] = leaks;
    json["notes"] = r.notes;
    json["checksum"] = r.checksum;
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

void writeReport(const RunReport& report, const std::filesystem::path& path) {
    OutputFile file(path);
    file.write(reportText(report));
    file.close();
}

} // namespace i2b
