#include "i2b/quality/quality_report.h"
#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace i2b {
namespace {

using Cells = std::vector<std::string>;

// Rows of text in columns as wide as their widest entry. Rows of a single entry are headings.
class Columns {
  public:
    explicit Columns(std::string alignment) : alignment_(std::move(alignment)) {}

    void add(Cells row) { rows_.push_back(std::move(row)); }
    std::string text() const {
        std::vector<std::size_t> widths(alignment_.size(), 0);
        for (const Cells& row : rows_)
            for (std::size_t i = 0; row.size() > 1 && i < row.size(); ++i)
                widths[i] = std::max(widths[i], row[i].size());
        std::string text;
        for (const Cells& row : rows_) {
            std::string line;
            for (std::size_t i = 0; i < row.size(); ++i) {
                const std::string_view gap = i > 0 ? "  " : "";
                if (alignment_[i] == '>')
                    line += fmt::format("{}{:>{}}", gap, row[i], widths[i]);
                else
                    line += fmt::format("{}{:<{}}", gap, row[i], widths[i]);
            }
            line.erase(line.find_last_not_of(' ') + 1);
            text += line + '\n';
        }
        return text;
    }

  private:
    std::string alignment_; // '<' or '>' per column
    std::vector<Cells> rows_;
};

struct Numbers {
    int digits;

    std::string operator()(double v) const { return fmt::format("{:.{}g}", v, digits); }
    std::string operator()(const Vec3& v) const {
        return fmt::format("({} {} {})", (*this)(v.x), (*this)(v.y), (*this)(v.z));
    }
    std::string operator()(const Box& b) const { return (*this)(b.lo) + " to " + (*this)(b.hi); }
};

std::string shapesText(const MeshStatistics& s) {
    std::vector<std::string> kinds;
    const auto add = [&](std::int64_t n, const char* name) {
        if (n > 0) kinds.push_back(fmt::format("{} {}", n, name));
    };
    add(s.hexahedra, "hexahedra");
    add(s.prisms, "prisms");
    add(s.wedges, "wedges");
    add(s.pyramids, "pyramids");
    add(s.tetrahedra, "tetrahedra");
    add(s.tetWedges, "tetrahedral wedges");
    add(s.polyhedra, "polyhedra");
    return fmt::format("{}", fmt::join(kinds, ", "));
}

std::string meshText(const QualityReport& r, const Numbers& num) {
    const MeshStatistics& s = r.statistics;
    Columns t("<<");
    t.add({"cells", std::to_string(r.cells)});
    if (r.cells > 0) t.add({"  shapes", shapesText(s)});
    std::vector<std::string> polyhedra;
    for (const auto& [faces, cells] : s.polyhedraByFaces)
        polyhedra.push_back(fmt::format("{} x {}", cells, faces));
    if (!polyhedra.empty()) t.add({"  faces of polyhedra", fmt::format("{}", fmt::join(polyhedra, ", "))});
    t.add({"faces",
           fmt::format("{}, {} inside; {} per cell", r.faces, r.internalFaces,
                       num(double(r.faces + r.internalFaces) / double(std::max<std::int64_t>(1, r.cells))))});
    t.add({"points", s.internalPoints < 0 ? std::to_string(r.points)
                                          : fmt::format("{}, {} inside", r.points, s.internalPoints)});
    if (s.internalPoints >= 0)
        t.add({"edges",
               fmt::format("{}, {} inside, of which {} with one end on the boundary, {} with both", s.edges,
                           s.internalEdges, s.internalEdgesOnePoint, s.internalEdgesTwoPoints)});
    t.add({"box (m)", num(r.box)});
    t.add({"cell volume (m3)",
           fmt::format("{} to {}, {} in all", num(r.minVolume), num(r.maxVolume), num(r.totalVolume))});
    t.add({"face area (m2)", fmt::format("{} to {}", num(r.minFaceArea), num(r.maxFaceArea))});
    t.add({"edge length (m)", fmt::format("{} to {}", num(r.minEdgeLength), num(r.maxEdgeLength))});
    const auto axes = [](const std::array<int, 3>& d) {
        std::string names;
        for (std::size_t k = 0; k < 3; ++k)
            if (d[k] == 1) names += "xyz"[k];
        return names.empty() ? std::string("none") : names;
    };
    if (axes(r.geometricDirections) != "xyz")
        t.add({"directions", fmt::format("{} solved, {} neither empty nor wedge", axes(r.solutionDirections),
                                         axes(r.geometricDirections))});
    for (const WedgeQuality& w : r.wedges)
        t.add({"wedge", fmt::format("{}, {} degrees from its plane", w.name, num(w.angle))});
    return t.text();
}

const char* surfaceText(SurfaceTopology topology) {
    switch (topology) {
    case SurfaceTopology::empty:
        return "no faces";
    case SurfaceTopology::closed:
        return "closed";
    case SurfaceTopology::sharedPoint:
        return "closed, pinched to a point";
    case SurfaceTopology::open:
        return "open";
    case SurfaceTopology::sharedEdge:
        return "more than two faces at an edge";
    }
    return "";
}

std::string partsText(const QualityReport& r, const Numbers& num) {
    Columns patches("<>><<");
    patches.add({"Patch", "faces", "points", "as a surface", "box (m)"});
    for (const PatchQuality& p : r.patches)
        patches.add({p.name, std::to_string(p.faces), std::to_string(p.points), surfaceText(p.topology),
                     p.points > 0 ? num(p.box) : ""});
    std::string text = patches.text();
    if (!r.zones.empty()) {
        Columns zones("<>>><");
        zones.add({"Zone", "cells", "points", "volume (m3)", "box (m)"});
        for (const ZoneQuality& z : r.zones)
            zones.add({z.name, std::to_string(z.cells), std::to_string(z.points), num(z.volume), num(z.box)});
        text += '\n' + zones.text();
    }
    if (r.regions.size() > 1) {
        Columns regions(">><");
        regions.add({"Region", "cells", "touches another"});
        for (std::size_t i = 0; i < r.regions.size(); ++i)
            regions.add({std::to_string(i), std::to_string(r.regions[i].cells),
                         r.regions[i].pointConnected ? "at a point" : "nowhere"});
        text += '\n' + regions.text();
    }
    return text;
}

enum class Verdict { ok, warns, fails };

// One line of the table; fields that a check has no use for stay empty.
struct Row {
    std::string quantity = {}, worst = {}, mean = {}, limit = {};
    std::string found = "-"; // how many of what
    Verdict verdict = Verdict::ok;
    std::string where = {};
};

class CheckTable {
  public:
    CheckTable(const QualityReport& report, const Numbers& num) : r_(report), num_(num) {}

    void heading(const char* name) { table_.add({name, "worst", "mean", "limit", "found", "", "where (m)"}); }

    // found: how many; the verdict and the place come from the check of that name, which is there only if
    // something fails it
    void add(const char* quantity, const char* check, std::int64_t found, const char* items, Row row = {}) {
        row.quantity = quantity;
        if (found > 0) {
            row.found = fmt::format("{} {}", found, items);
            row.verdict = Verdict::warns;
            if (const QualityCheck* c = findCheck(r_, check)) {
                if (c->fails) row.verdict = Verdict::fails;
                row.where = num_(c->worst);
            }
        }
        add(std::move(row));
    }
    // by the check's own count
    void add(const char* quantity, const char* check, const char* items, Row row = {}) {
        const QualityCheck* c = findCheck(r_, check);
        add(quantity, check, c != nullptr ? c->count : 0, items, std::move(row));
    }
    void add(Row row) {
        static constexpr const char* verdicts[] = {"ok", "warns", "FAILS"};
        table_.add({"  " + row.quantity, row.worst, row.mean, row.limit, row.found,
                    verdicts[static_cast<int>(row.verdict)], row.where});
        ++checks_;
    }
    int checks() const { return checks_; }
    std::string text() const { return table_.text(); }

    Row figures(double worst, double limit) const { return {.worst = num_(worst), .limit = num_(limit)}; }
    Row figures(double worst, double mean, double limit) const {
        return {.worst = num_(worst), .mean = num_(mean), .limit = num_(limit)};
    }

  private:
    const QualityReport& r_;
    const Numbers& num_;
    Columns table_{"<>>>><<"};
    int checks_ = 0;
};

void topology(CheckTable& t, const QualityReport& r) {
    t.heading("Topology");
    const auto plain = [](const char* quantity, bool good) {
        return Row{quantity, {}, {}, {}, "-", good ? Verdict::ok : Verdict::warns, {}};
    };
    t.add(plain("patches in sequence, each name once", r.boundaryDefined));
    t.add(plain("same number of empty faces at every cell", r.emptyFacesDivide));
    t.add("cells of fewer than four faces", "illegalCells", "cells");
    t.add("points of no face", "unusedPoints", "points");
    if (r.upperTriangular) // the set may still name faces, of cells with several to one neighbour
        t.add(plain("faces against the order of their cells", true));
    else
        t.add("faces against the order of their cells", "upperTriangularFace", "faces");
    t.add("cells with several faces to one neighbour", "", r.multiplyConnectedCells, "cells");
    t.add("faces that use a point twice", "outOfRangeFaces", "faces");
    t.add("regions that no face joins", "", r.regions.size() > 1 ? std::int64_t(r.regions.size()) : 0,
          "regions");
    t.add("points of several regions", "multiRegionPoints", "points");
    t.add("patches pinched or branching", "nonManifoldPoints", "points");
}

void geometry(CheckTable& t, const QualityReport& r, const Numbers& num) {
    t.heading("Geometry");
    double gap = 0;
    for (int k = 0; k < 3; ++k)
        if (std::abs(r.boundaryOpenness[k]) >= std::abs(gap)) gap = r.boundaryOpenness[k];
    const double closedness = r.limits.closedness;
    t.add({"boundary openness",
           num(gap),
           {},
           num(closedness),
           "-",
           std::abs(gap) > closedness ? Verdict::fails : Verdict::ok,
           {}});
    t.add("edges off the plane or axis of a 2D or 1D mesh", "nonAlignedEdges", r.misalignedEdges, "edges");
    t.add("cell openness", "nonClosedCells", r.openCells, "cells", t.figures(r.maxOpenness, closedness));
    t.add("aspect ratio", "highAspectRatioCells", r.highAspectRatioCells, "cells",
          t.figures(r.maxAspectRatio, r.limits.aspectRatio));
    t.add("face area (m2)", "zeroAreaFaces", "faces", t.figures(r.minFaceArea, r.limits.faceArea));
    t.add("cell volume (m3)", "zeroVolumeCells", r.negativeVolumeCells, "cells",
          t.figures(r.minVolume, r.limits.smallVolume));
    const bool inside = r.internalFaces > 0;
    Row angles =
        inside ? t.figures(r.maxNonOrthogonality, r.meanNonOrthogonality, r.limits.nonOrthogonality) : Row{};
    angles.quantity = "non-orthogonality (degrees)";
    if (const QualityCheck* c = findCheck(r, "nonOrthoFaces")) {
        angles.found = fmt::format("{} faces", c->count);
        angles.verdict = Verdict::warns; // only those of the next line fail
        angles.where = num(c->worst);
    }
    t.add(std::move(angles));
    t.add("  of 90 degrees and more", "nonOrthoFaces", r.nonOrthogonalityErrors, "faces");
    t.add("faces that point into their cell", "wrongOrientedFaces", r.wrongOrientedFaces, "sides");
    t.add("skewness", "skewFaces", r.highlySkewFaces, "faces", t.figures(r.maxSkewness, r.limits.skewness));
}

void extended(CheckTable& t, const QualityReport& r, const Numbers& num) {
    t.heading("Extended");
    t.add("cells open along an edge", "zipUpCells", r.openCellsByEdges, "cells");
    t.add("pairs of faces on the same points", "", r.baffleFaces, "pairs");
    t.add("faces on some of the points of another", "", r.duplicateFaces, "faces");
    t.add("faces that share points not in sequence", "", r.nonConsecutiveFaces, "faces");
    t.add("faces of such pairs, in all", "edgeFaces", "faces");
    t.add("cells with at most one inner face", "oneInternalFaceCells", "cells");
    t.add("cells with two inner faces", "twoInternalFacesCells", "cells");
    t.add("faces that divide into poor tetrahedra", "lowQualityTetFaces", r.tetErrors, "cases");
    t.add("edge length (m)", "shortEdges", r.shortEdgePoints, "points",
          t.figures(r.minEdgeLength, r.nearDistance));
    t.add("points nearly at one place", "nearPoints", "points", Row{.limit = num(r.nearDistance)});
    t.add("inward corner of a face (degrees)", "concaveFaces", r.concaveFaces, "faces",
          t.figures(r.maxConcaveAngle, r.limits.concavity));
    t.add("flatness of faces", "warpedFaces", r.warpedFaces, "faces",
          r.flatnessFaces > 0 ? t.figures(r.minFaceFlatness, r.meanFaceFlatness, r.limits.flatness) : Row{});
    t.add("determinant", "underdeterminedCells", r.smallDeterminantCells, "cells",
          t.figures(r.minDeterminant, r.meanDeterminant, r.limits.determinant));
    t.add("concave cells", "concaveCells", r.concaveCells, "cells");
    const bool inside = r.internalFaces > 0;
    t.add("face weight", "lowWeightFaces", r.lowWeightFaces, "faces",
          inside ? t.figures(r.minFaceWeight, r.meanFaceWeight, r.limits.faceWeight) : Row{});
    t.add("volume ratio of neighbours", "lowVolRatioFaces", r.lowVolumeRatioFaces, "faces",
          inside ? t.figures(r.minVolumeRatio, r.meanVolumeRatio, r.limits.volumeRatio) : Row{});
}

// The limits of the mesh quality dictionary: what is beyond each, whatever checkMesh's other checks say.
std::string dictionaryText(const QualityReport& r, const Numbers& num) {
    const auto name = [&](const std::string& key) -> std::string {
        static const std::pair<const char*, const char*> names[] = {
            {"maxNonOrtho", "non-orthogonality (degrees)"}, {"minVol", "pyramid on a face (m3)"},
            {"minTetQuality", "tetrahedra of a face"}, {"maxConcave", "inward corner of a face (degrees)"},
            {"minArea", "face area (m2)"}, {"maxInternalSkewness", "skewness inside"},
            {"maxBoundarySkewness", "skewness on the boundary"}, {"minFaceWeight", "face weight"},
            {"minVolRatio", "volume ratio of neighbours"}, {"minTwist", "twist of a face (cosine)"},
            {"minTriangleTwist", "twist of its triangles (cosine)"}, {"minFaceFlatness", "flatness, triangles over face"},
            {"minDeterminant", "determinant, by all faces"}};
        const auto* const found = std::find_if(std::begin(names), std::end(names), [&](const auto& n) { return key == n.first; });
        return found == std::end(names) ? key : found->second;
    };
    Columns t("<<>>><");
    t.add({"Mesh quality dictionary", "entry", "worst", "limit", "beyond", "where (m)"});
    for (const DictionaryCheck& check : r.dictionary) {
        std::string worst, beyond = check.asked ? "-" : "not asked";
        if (check.key == "maxNonOrtho" && r.internalFaces > 0) worst = num(r.maxNonOrthogonality);
        if (check.key == "minArea") worst = num(r.minFaceArea);
        if (check.key == "minFaceWeight" && r.internalFaces > 0) worst = num(r.minFaceWeight);
        if (check.key == "minVolRatio" && r.internalFaces > 0) worst = num(r.minVolumeRatio);
        if (check.key == "minDeterminant") worst = num(r.minFullness);
        if (check.faces > 0) beyond = fmt::format("{} faces", check.faces);
        if (check.cells > 0) beyond = fmt::format("{} faces of {} cells", check.faces, check.cells);
        t.add({"  " + name(check.key), check.key, worst, num(check.limit), beyond, check.faces > 0 ? num(check.worst) : ""});
    }
    return t.text() + (r.dictionaryFaces == 0 ? std::string("no face is beyond a limit of the dictionary\n")
                                              : fmt::format("{} of {} faces are beyond a limit of the dictionary\n",
                                                            r.dictionaryFaces, r.faces));
}

} // namespace

std::string formatQuality(const QualityReport& report, int digits) {
    const Numbers num{digits};
    CheckTable checks(report, num);
    topology(checks, report);
    geometry(checks, report, num);
    extended(checks, report, num);
    return fmt::format("{}\n{}\n{}\n{}\n{}", meshText(report, num), partsText(report, num), checks.text(), dictionaryText(report, num),
                       report.ok()
                           ? "all checks pass\n"
                           : fmt::format("{} of {} checks fail\n", report.failedChecks, checks.checks()));
}

} // namespace i2b
