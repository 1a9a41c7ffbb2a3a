#include "i2b/write/report_write.h"
#include "write/mesh_samples.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>
#include <nlohmann/json.hpp>

namespace i2b {
namespace {

using Json = nlohmann::ordered_json;

std::vector<std::string> keys(const Json& json) {
    std::vector<std::string> all;
    for (const auto& item : json.items()) all.push_back(item.key());
    return all;
}

RunReport sample() {
    RunReport r;
    r.programVersion = "0.1.0";
    r.files = {"body.stl"};
    r.triangles = 12;
    r.parts = {{"body", 12}};
    r.threads = 2;
    r.surfaceSize = 0.5, r.minSize = 0.25, r.maxSize = 4, r.levels = 4;
    r.stages = {{"grid", 1.5, 100}};
    r.cells = 10;
    r.quality.emplace();
    r.quality->maxSkewness = 1.25;
    r.quality->dictionary = {{"maxNonOrtho", 65, true, 0, 0, 0, {}}, {"minDeterminant", 0.001, true, 6, 0, 1, {}}};
    r.quality->dictionaryFaces = 6;
    r.changes = {2, 3, {{1, 2, 3}}, 4};
    r.fit.emplace();
    r.fitCutShort = true;
    r.fit->lostEdges = {{0.5, 0.25, 0, 0}, 4, {{0.5, {1, 2, 3}, {{0, 2, 3}, {2, 2, 3}}, "body", LostCause::shallow}}};
    r.offGeometry.emplace();
    r.offGeometry->counts[static_cast<std::size_t>(OffCause::gap)] = 3;
    r.offGeometry->places = {1, {{3, {1, 2, 3}, {{1, 2, 3}, {1, 2, 3}}, 0.5, {1, 2, 3}, OffCause::gap, "body"}}};
    r.layers = LayerReport{3, 2.5, 1, 0.99, 2e-3, 1e-3, 3e-3, {{"body", 3, 1e-3, 4e-3, 2.5, 2e-3, 3e-3, 6, {3, 2, 1, 0}}}};
    r.patches = {{"body", "wall", 5, 6}};
    r.regions.resize(1);
    r.regions[0].name = "outside";
    r.regions[0].parts = {0};
    r.regions[0].box.add(Vec3{1, 2, 3});
    Leak& leak = r.leaks.emplace_back();
    leak.place = {1, 2, 3}, leak.width = 0.5, leak.text = "through body", leak.area = 0.25, leak.box = Box{{0, 2, 3}, {2, 2, 3}};
    r.notes = {"a limit is out of reach"};
    r.checksum = "0123456789abcdef";
    return r;
}

// Exactly the keys that others rely on, in order, with the values given.
TEST(ReportWrite, HasTheContractsKeys) {
    const Json json = Json::parse(reportText(sample()));
    EXPECT_THAT(keys(json),
                testing::ElementsAre("program", "geometry", "threads", "sizes", "seconds", "peak_rss_bytes",
                                     "stages", "cells", "faces", "points", "wall_faces", "quality", "fit",
                                     "layers", "patches", "regions", "leaks", "notes", "checksum"));
    EXPECT_THAT(keys(json["program"]), testing::ElementsAre("name", "version"));
    EXPECT_THAT(keys(json["geometry"]), testing::ElementsAre("files", "triangles", "parts"));
    EXPECT_THAT(keys(json["sizes"]), testing::ElementsAre("surface", "min", "max", "levels"));
    EXPECT_THAT(keys(json["stages"][0]), testing::ElementsAre("name", "seconds", "items", "rss_bytes", "peak_rss_bytes"));
    EXPECT_THAT(keys(json["quality"]),
                testing::ElementsAre("ok", "negative_volume_cells", "wrong_oriented_faces",
                                     "max_non_orthogonality", "mean_non_orthogonality", "max_skewness",
                                     "max_aspect_ratio", "min_face_weight", "min_volume_ratio",
                                     "min_determinant", "concave_cells", "faces_beyond_limits", "limits", "changes"));
    EXPECT_EQ(json["quality"]["changes"].dump(), R"({"merged_cells":2,"divided_faces":3,"joined_rim_nodes":4,"places":[[1.0,2.0,3.0]]})");
    EXPECT_THAT(keys(json["quality"]["limits"]), testing::ElementsAre("maxNonOrtho", "minDeterminant"));
    EXPECT_THAT(keys(json["quality"]["limits"]["minDeterminant"]), testing::ElementsAre("limit", "asked", "faces", "cells", "worst"));
    EXPECT_THAT(keys(json["fit"]), testing::ElementsAre("wall_nodes_on_geometry_fraction",
                                                        "mean_distance_in_h", "max_distance_in_h",
                                                        "feature_capture_fraction", "faint_capture_fraction",
                                                        "faint_samples", "tilted_face_fraction",
                                                        "tilted_45_face_fraction",
                                                        "cut_short", "lost_edges", "off_geometry"));
    EXPECT_EQ(json["fit"]["lost_edges"].dump(),
              R"({"length":0.75,"length_by_cause":{"shallow":0.5,"crossed":0.25,"bridged":0.0,"left_out":0.0},"places_total":4,)"
              R"("places":[{"length":0.5,"part":"body","cause":"shallow","at":[1.0,2.0,3.0],"box":[[0.0,2.0,3.0],[2.0,2.0,3.0]]}]})");
    const Json& off = json["fit"]["off_geometry"];
    EXPECT_THAT(keys(off), testing::ElementsAre("nodes", "fraction", "causes", "places_total", "places", "tilted_nodes",
                                                "tilted_places_total", "tilted_places"));
    EXPECT_THAT(keys(off["causes"]), testing::ElementsAre("quality", "beside_edge", "feature", "feature_off", "gap", "bridged",
                                                          "sheet_between", "box_side", "unfinished", "retreated"));
    EXPECT_THAT(keys(off["places"][0]),
                testing::ElementsAre("nodes", "cause", "part", "centre", "box", "max_distance_in_h", "farthest"));
    EXPECT_EQ(off["causes"]["gap"], 3);
    EXPECT_EQ(off["places"][0]["cause"], "gap");
    EXPECT_EQ(off["places"][0]["part"], "body");
    EXPECT_EQ(off["places_total"], 1);
    EXPECT_EQ(json["fit"]["cut_short"], true);
    EXPECT_THAT(keys(json["layers"]), testing::ElementsAre("requested", "mean_count",
                                                           "faces_covered_fraction", "thickness_fraction",
                                                           "mean_first_height", "min_first_height", "max_first_height", "parts"));
    EXPECT_EQ(json["layers"]["max_first_height"], 3e-3);
    const Json row = json["layers"]["parts"][0];
    EXPECT_THAT(keys(row), testing::ElementsAre("name", "requested", "requested_first_height", "requested_thickness", "mean_count",
                                                "mean_first_height", "mean_thickness", "faces", "faces_short"));
    EXPECT_EQ(row["name"], "body");
    EXPECT_EQ(row["mean_count"], 2.5);
    EXPECT_EQ(row["mean_thickness"], 3e-3);
    EXPECT_THAT(keys(row["faces_short"]), testing::ElementsAre("taper", "compressed", "room", "merged"));
    EXPECT_EQ(row["faces_short"]["taper"], 2);
    EXPECT_EQ(row["faces_short"]["compressed"], 1);
    EXPECT_THAT(keys(json["patches"][0]), testing::ElementsAre("name", "type", "faces"));
    EXPECT_EQ(json["quality"]["ok"], true);
    EXPECT_EQ(json["quality"]["max_skewness"], 1.25);
    EXPECT_EQ(json["quality"]["faces_beyond_limits"], 6);
    EXPECT_EQ(json["quality"]["limits"]["maxNonOrtho"]["limit"], 65);
    EXPECT_EQ(json["quality"]["limits"]["minDeterminant"]["faces"], 6);
    EXPECT_EQ(json["patches"][0]["faces"], 6);
    EXPECT_EQ(json["regions"][0]["parts"][0], "body");
    EXPECT_EQ(json["leaks"][0]["width"], 0.5);
    EXPECT_EQ(json["leaks"][0]["area"], 0.25);
    EXPECT_EQ(json["leaks"][0]["box"][1][0], 2);
    EXPECT_EQ(json["notes"], Json({"a limit is out of reach"}));
    EXPECT_EQ(json["stages"][0]["items"], 100);
}

// A number that JSON cannot hold is null wherever it turns up, a part of the run that was not reached
// likewise, and a file name that is not UTF-8 does not stop the report.
TEST(ReportWrite, NotFiniteIsNull) {
    RunReport r = sample();
    r.quality->maxSkewness = std::numeric_limits<double>::quiet_NaN();
    r.fit->maxDistanceInH = std::numeric_limits<double>::infinity();
    r.regions[0].box = Box();
    r.seconds = -std::numeric_limits<double>::infinity();
    r.layers.reset();
    r.files = {"b\xff.stl"};
    const Json json = Json::parse(reportText(r));
    EXPECT_TRUE(json["quality"]["max_skewness"].is_null());
    EXPECT_TRUE(json["fit"]["max_distance_in_h"].is_null());
    EXPECT_TRUE(json["regions"][0]["box"][0][0].is_null());
    EXPECT_TRUE(json["seconds"].is_null());
    EXPECT_TRUE(json["layers"].is_null());
    EXPECT_EQ(json["geometry"]["files"][0], "b\xEF\xBF\xBD.stl");
}

// The file holds the same text.
TEST(ReportWrite, WritesTheFile) {
    const test::TempFolder temp;
    writeReport(sample(), temp / "report.json");
    EXPECT_EQ(test::contents(temp / "report.json"), reportText(sample()));
}

} // namespace
} // namespace i2b
