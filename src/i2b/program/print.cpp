#include "i2b/program/print.h"
#include "i2b/program/progress.h"
#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <numeric>

namespace i2b {
namespace {

constexpr double negligible = 1e-6; // of the largest region's volume

std::string placeText(const Vec3& p) { return fmt::format("({:.6g} {:.6g} {:.6g})", p.x, p.y, p.z); }

std::string partNames(const Region& region, const std::vector<ReportPart>& parts) {
    constexpr std::size_t most = 4;
    std::vector<std::string> names;
    for (const std::int32_t part : region.parts) {
        if (names.size() == most) {
            names.push_back(fmt::format("and {} more", region.parts.size() - most));
            break;
        }
        names.push_back(parts.at(static_cast<std::size_t>(part)).name);
    }
    return fmt::format("{}", fmt::join(names, ", "));
}

std::string regionLine(const Region& region, const std::vector<ReportPart>& parts) {
    const Box& b = region.box;
    return fmt::format("{:<3} {:<12} {:>9} cells {:>11.4g} m3  ({:.4g} {:.4g} {:.4g}) to ({:.4g} {:.4g} {:.4g}){}  "
                       "--seed {:.6g},{:.6g},{:.6g}  {}\n",
                       region.painted ? "yes" : "no", region.name, countText(region.cells), region.volume, b.lo.x,
                       b.lo.y, b.lo.z, b.hi.x, b.hi.y, b.hi.z, region.touchesDomainBox ? "  meets the domain box" : "",
                       region.seed.x, region.seed.y, region.seed.z, partNames(region, parts));
}

// One line: how many places there are where something is so, and the first three, which are the worst; tell(place) says it of one.
template <class Places, class Tell>
std::string placesLine(const Places& places, const std::string& what, const Tell& tell) {
    constexpr std::size_t most = 3;
    std::vector<std::string> worst;
    for (std::size_t i = 0; i < std::min(most, places.first.size()); ++i) worst.push_back(tell(places.first[i]));
    return fmt::format("{} place{} where {}: {}{}\n", places.total, places.total == 1 ? "" : "s", what, fmt::join(worst, "; "),
                       places.total > static_cast<std::int64_t>(worst.size()) ? "; ..." : "");
}

std::string offGeometryLine(const OffPlaces& places) {
    return placesLine(places, "the wall is over 0.01 h off", [](const OffPlace& p) {
        return fmt::format("{} node{} at ({:.4g} {:.4g} {:.4g}) on {}, up to {:.2g} h, {}", p.nodes, p.nodes == 1 ? "" : "s", p.farthest.x,
                           p.farthest.y, p.farthest.z, p.part, p.farthestInH, nameOf(p.cause));
    });
}

std::string lostEdgesLine(const LostEdges& lost) {
    std::vector<std::string> causes;
    for (std::size_t i = 0; i < lostCauses; ++i)
        if (lost.lengthOf[i] > 0) causes.push_back(fmt::format("{:.2g} m {}", lost.lengthOf[i], nameOf(static_cast<LostCause>(i))));
    return placesLine(lost, fmt::format("sharp edges are lost, {:.2g} m in all ({})", lost.length(), fmt::join(causes, ", ")), [](const LostEdge& e) {
        return fmt::format("{:.2g} m at ({:.4g} {:.4g} {:.4g}) on {}, {}", e.length, e.at.x, e.at.y, e.at.z, e.part, nameOf(e.cause));
    });
}

// By the names of the sets that checkMesh -allGeometry writes.
std::string verdict(const QualityReport& q) {
    std::vector<std::string> failing;
    for (const QualityCheck& check : q.checks)
        if (check.fails) failing.push_back(fmt::format("{} {}", check.count, check.name));
    if (q.ok()) return "all checks pass";
    if (failing.empty()) return fmt::format("{} of the checks of checkMesh -allGeometry fail", q.failedChecks);
    return fmt::format("all checks of checkMesh -allGeometry pass but that of {}", fmt::join(failing, ", "));
}

// Layers much lower than they are wide fail a check of plain checkMesh, which no point can mend: says what would.
std::string aspectLine(const RunReport& report) {
    const QualityReport& q = *report.quality;
    const QualityCheck* const check = findCheck(q, "highAspectRatioCells");
    if (check == nullptr || q.highAspectRatioCells == 0) return "";
    std::string text = fmt::format("checkMesh reports {} cells with an aspect ratio over {:g}, up to {:.0f} at ({:.4g} {:.4g} {:.4g})",
                                   q.highAspectRatioCells, q.limits.aspectRatio, q.maxAspectRatio, check->worst.x, check->worst.y, check->worst.z);
    const double excess = q.maxAspectRatio / q.limits.aspectRatio;
    if (report.layers && report.layers->meanFirst > 0)
        text += fmt::format(": layers of {:.3g} m are that thin for cells of {:.3g} m; a first layer of {:.2g} m or cells of {:.2g} m there pass",
                            report.layers->minFirst, report.surfaceSize, report.layers->minFirst * excess, report.surfaceSize / excess);
    return text + "\n";
}

} // namespace

std::string fitText(const FitReport& fit) {
    return fmt::format("Fit to the geometry (h: size of the local wall cell)\n"
                       "    wall nodes within 0.01 h: {:.2f} % of {}\n"
                       "    wall face centres: {:.4f} h off on average; farthest wall node {:.4f} h, at "
                       "({:.6g} {:.6g} {:.6g})\n"
                       "    sharp edges captured: {:.2f} % of {} samples\n"
                       "    faces tilted over 25 degrees: {:.2f} %, over 45: {:.2f} %\n",
                       100 * fit.wallNodesOnGeometryFraction, fit.wallNodes, fit.meanDistanceInH,
                       fit.maxDistanceInH, fit.farthest.x, fit.farthest.y, fit.farthest.z,
                       100 * fit.featureCaptureFraction, fit.featureSamples, 100 * fit.tiltedFaceFraction,
                       100 * fit.tilted45FaceFraction) +
           (fit.lostEdges.total == 0 ? "" : "    " + lostEdgesLine(fit.lostEdges)) +
           (fit.faintSamples == 0 ? "" : fmt::format("    named and other faint edges captured: {:.2f} % of {} samples\n", 100 * fit.faintCaptureFraction, fit.faintSamples)) +
           (fit.borderSamples == 0 ? "" : fmt::format("    borders between parts captured: {:.2f} % of {} samples\n", 100 * fit.partBorderFraction, fit.borderSamples));
}

std::string regionRecord(const Region& region, const std::vector<ReportPart>& parts) {
    std::string text = fmt::format("volume {:.9g} box", region.volume);
    for (const Vec3& p : {region.box.lo, region.box.hi}) text += fmt::format(" {:.9g} {:.9g} {:.9g}", p.x, p.y, p.z);
    text += fmt::format(" seed {:.9g} {:.9g} {:.9g} domain-box {} painted {} parts", region.seed.x, region.seed.y,
                        region.seed.z, region.touchesDomainBox ? "yes" : "no", region.painted ? "yes" : "no");
    for (const std::int32_t part : region.parts) text += " " + parts.at(static_cast<std::size_t>(part)).name;
    return text;
}

std::string regionsText(const Regions& regions, const std::vector<ReportPart>& parts) {
    std::vector<const Region*> bySize;
    for (const Region& region : regions.table) bySize.push_back(&region);
    std::ranges::stable_sort(bySize, std::greater{}, &Region::volume);
    const double least = bySize.empty() ? 0 : negligible * bySize.front()->volume;
    std::string text = "painted, name, cells, volume, extent in m, seed, parts beside it\n";
    std::size_t small = 0;
    for (const Region* region : bySize) {
        if (region->volume < least && !region->painted)
            ++small;
        else
            text += regionLine(*region, parts);
    }
    if (small) text += fmt::format("and {} regions smaller than {:.2g} m3\n", small, least);
    constexpr std::size_t mostLeaks = 50; // a report has all
    for (std::size_t i = 0; i < std::min(mostLeaks, regions.leaks.size()); ++i) {
        const Leak& leak = regions.leaks[i];
        text += fmt::format("leak {:.4g} m wide at {:.6g},{:.6g},{:.6g}", leak.width, leak.place.x, leak.place.y, leak.place.z);
        if (leak.area > 0) text += fmt::format(", {:.3g} m2, from {} to {}", leak.area, placeText(leak.box.lo), placeText(leak.box.hi));
        text += ": " + leak.text + "\n";
    }
    if (regions.leaks.size() > mostLeaks) text += fmt::format("and {} leaks more\n", regions.leaks.size() - mostLeaks);
    return text;
}

std::string summaryText(const RunReport& report) {
    std::string text =
        fmt::format("{} cells, {} faces, {} points in {:.1f} s and {:.0f} MB\n", report.cells, report.faces,
                    report.points, report.seconds, static_cast<double>(report.peakRssBytes) * 1e-6);
    if (const auto& q = report.quality)
        text += fmt::format(
            "quality: {}; non-orthogonality {:.1f} at most, {:.1f} on average; skewness {:.2f}{}\n", verdict(*q),
            q->maxNonOrthogonality, q->meanNonOrthogonality, q->maxSkewness,
            q->dictionaryFaces > 0 ? fmt::format("; {} faces beyond the limits", q->dictionaryFaces) : "");
    if (report.quality) text += aspectLine(report);
    if (const auto& f = report.fit)
        text += fmt::format(
            "fit: {:.2f} % of the wall nodes on the geometry, {:.1f} % of the sharp edges captured\n",
            100 * f->wallNodesOnGeometryFraction, 100 * f->featureCaptureFraction);
    if (report.fit && report.fit->faintSamples > 0)
        text += fmt::format("named and other faint edges: {:.1f} % captured\n", 100 * report.fit->faintCaptureFraction);
    if (report.fit && report.fit->lostEdges.total > 0) text += lostEdgesLine(report.fit->lostEdges);
    if (report.offGeometry && report.offGeometry->places.total > 0) text += offGeometryLine(report.offGeometry->places);
    if (report.fitCutShort) text += "the fit was cut short by --fit-seconds: another run may give another mesh\n";
    if (const auto& l = report.layers)
        text += fmt::format(
            "layers: {:.2f} of {} on average, {:.1f} % of the faces covered, {:.1f} % of the thickness; first height {:.3g} m\n",
            l->meanCount, l->requested, 100 * l->facesCoveredFraction, 100 * l->thicknessFraction, l->meanFirst);
    return text;
}

} // namespace i2b
