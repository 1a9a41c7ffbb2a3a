#include "i2b/program/print.h"
#include <gmock/gmock.h>

namespace i2b {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

RunReport sample() {
    RunReport report;
    report.fit.emplace();
    report.offGeometry.emplace();
    return report;
}

// An opening with its place, size and extent; of many the first.
TEST(RegionsText, TellsLeaks) {
    Regions regions;
    Leak& leak = regions.leaks.emplace_back();
    leak.place = {1, 2, 3}, leak.width = 0.25, leak.area = 0.5, leak.box = Box{{0, 2, 3}, {2, 2, 4}}, leak.text = "'a' and 'b' reach each other";
    EXPECT_THAT(regionsText(regions, {}), HasSubstr("leak 0.25 m wide at 1,2,3, 0.5 m2, from (0 2 3) to (2 2 4): 'a' and 'b' reach each other\n"));
    regions.leaks.resize(60, regions.leaks.front());
    EXPECT_THAT(regionsText(regions, {}), HasSubstr("and 10 leaks more\n"));
    regions.leaks.resize(1);
    regions.leaks[0].area = 0;
    EXPECT_THAT(regionsText(regions, {}), HasSubstr("at 1,2,3: 'a'"));
}

// How many places, then the first three with number, place, part, distance and cause.
TEST(SummaryText, NamesTheWorstPlaces) {
    RunReport report = sample();
    OffPlaces& places = report.offGeometry->places;
    for (int i = 0; i < 4; ++i) {
        OffPlace& p = places.first.emplace_back();
        p.nodes = 4 - i;
        p.farthest = {1.5, double(i), -2};
        p.farthestInH = 0.25;
        p.cause = OffCause::sheetBetween;
        p.part = "part" + std::to_string(i);
    }
    places.total = 7;
    EXPECT_THAT(summaryText(report), HasSubstr("\n7 places where the wall is over 0.01 h off: 4 nodes at (1.5 0 -2) on part0, up to 0.25 h, "
                                               "sheet_between; 3 nodes at (1.5 1 -2) on part1, up to 0.25 h, sheet_between; "
                                               "2 nodes at (1.5 2 -2) on part2, up to 0.25 h, sheet_between; ...\n"));
    places.first.resize(1), places.first[0].nodes = 1, places.total = 1;
    EXPECT_THAT(summaryText(report), HasSubstr("\n1 place where the wall is over 0.01 h off: 1 node at (1.5 0 -2) on part0, up to 0.25 h, sheet_between\n"));
}

// The same of lost edges: how many stretches, how long in all, and the three longest.
TEST(SummaryText, NamesTheLongestLostEdges) {
    RunReport report = sample();
    EXPECT_THAT(summaryText(report), Not(HasSubstr("lost")));
    LostEdges& lost = report.fit->lostEdges;
    for (int i = 0; i < 4; ++i) lost.first.push_back({0.5 / (i + 1), {1.5, double(i), -2}, {}, "part" + std::to_string(i), static_cast<LostCause>(i)});
    lost.total = 9, lost.lengthOf = {0.75, 0, 0, 0.5};
    EXPECT_THAT(summaryText(report), HasSubstr("\n9 places where sharp edges are lost, 1.2 m in all (0.75 m shallow, 0.5 m left_out): 0.5 m at (1.5 0 -2) on part0, shallow; "
                                               "0.25 m at (1.5 1 -2) on part1, crossed; 0.17 m at (1.5 2 -2) on part2, bridged; ...\n"));
    lost.first.resize(1), lost.total = 1, lost.lengthOf = {0.5};
    EXPECT_THAT(fitText(*report.fit), HasSubstr("\n    1 place where sharp edges are lost, 0.5 m in all (0.5 m shallow): 0.5 m at (1.5 0 -2) on part0, shallow\n"));
}

// Checks that fail by name and number, those that only warn not; and what is beyond the limits of the dictionary.
TEST(SummaryText, NamesTheChecksThatFail) {
    RunReport report = sample();
    QualityReport& q = report.quality.emplace();
    EXPECT_THAT(summaryText(report), HasSubstr("\nquality: all checks pass; "));
    EXPECT_THAT(summaryText(report), Not(HasSubstr("beyond the limits")));
    q.checks = {{"nonOrthoFaces", 4, false, {}, {}}, {"concaveCells", 20, true, {}, {}}, {"lowWeightFaces", 1, true, {}, {}}};
    q.failedChecks = 2, q.dictionaryFaces = 5;
    EXPECT_THAT(summaryText(report), HasSubstr("\nquality: all checks of checkMesh -allGeometry pass but that of 20 concaveCells, 1 lowWeightFaces; "));
    EXPECT_THAT(summaryText(report), HasSubstr("; 5 faces beyond the limits\n"));
}

// Cells too thin for plain checkMesh: how many, where, and what would pass.
TEST(SummaryText, SaysWhereLayersAreTooThin) {
    RunReport report = sample();
    QualityReport& q = report.quality.emplace();
    EXPECT_THAT(summaryText(report), Not(HasSubstr("aspect ratio over")));
    q.highAspectRatioCells = 7, q.maxAspectRatio = 2000;
    q.checks.push_back({"highAspectRatioCells", 7, true, {1, 2, 3}, {}});
    report.surfaceSize = 0.03;
    report.layers.emplace();
    report.layers->meanFirst = report.layers->minFirst = 2e-5;
    EXPECT_THAT(summaryText(report), HasSubstr("\ncheckMesh reports 7 cells with an aspect ratio over 1000, up to 2000 at (1 2 3): layers of 2e-05 m "
                                               "are that thin for cells of 0.03 m; a first layer of 4e-05 m or cells of 0.015 m there pass\n"));
}

// Nothing is said where there is nothing to say.
TEST(SummaryText, SaysNothingOfAGoodWall) {
    RunReport report = sample();
    EXPECT_THAT(summaryText(report), Not(HasSubstr("place")));
    EXPECT_THAT(summaryText(report), Not(HasSubstr("cut short")));
    report.fitCutShort = true;
    EXPECT_THAT(summaryText(report), HasSubstr("cut short by --fit-seconds"));
}

} // namespace
} // namespace i2b
