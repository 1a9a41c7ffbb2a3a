#include "checkmesh_figures.h"
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <regex>

namespace i2b::test {
namespace {

using testing::ElementsAreArray;

// # stands for a number in the patterns below, blanks for any white space.
std::regex pattern(const std::string& text) {
    static const std::string number = R"((-?(?:\d+(?:\.\d+)?(?:e[-+]?\d+)?|nan|inf)))";
    std::string expression;
    for (const char c : text)
        if (c == '#')
            expression += number;
        else if (c == ' ')
            expression += R"(\s+)";
        else
            expression += c;
    return std::regex(expression);
}

std::string digits(double v) { return fmt::format("{:.17g}", v); }
std::string digits(std::int64_t v) { return std::to_string(v); }
std::string digits(std::size_t v) { return std::to_string(v); }

// What follows is held in one list of strings per side, so that a failure shows all that differs at once.
using Rows = std::vector<std::string>;

class Comparison {
  public:
    explicit Comparison(const std::string& output) : output_(output) {}

    // The numbers where the pattern first matches. It must match.
    template <class... Values>
    void same(const std::string& text, Values... values) {
        std::smatch match;
        if (!std::regex_search(output_, match, pattern(text))) {
            ADD_FAILURE() << "checkMesh says nothing like: " << text;
            return;
        }
        const Rows ours{digits(values)...};
        ASSERT_EQ(match.size(), ours.size() + 1) << text;
        for (std::size_t i = 0; i < ours.size(); ++i) EXPECT_EQ(ours[i], match[i + 1].str()) << text;
    }
    // A number that is named only where it is not zero.
    void sameCount(const std::string& text, std::int64_t value) {
        std::smatch match;
        const bool named = std::regex_search(output_, match, pattern(text));
        EXPECT_EQ(digits(value), named ? match[1].str() : "0") << text;
    }
    bool says(const std::string& text) const { return std::regex_search(output_, pattern(text)); }

    // Each match as its groups, joined by blanks.
    Rows all(const std::string& text, const std::string& from = "", const std::string& to = "") const {
        const std::size_t begin = from.empty() ? 0 : output_.find(from);
        if (begin == std::string::npos) return {};
        const std::string part =
            output_.substr(begin, to.empty() ? to.npos : output_.find(to, begin) - begin);
        const std::regex expression = pattern(text);
        Rows rows;
        for (std::sregex_iterator i(part.begin(), part.end(), expression), end; i != end; ++i) {
            std::string row;
            for (std::size_t g = 1; g < i->size(); ++g) row += (g > 1 ? " " : "") + (*i)[g].str();
            row.erase(row.find_last_not_of(' ') + 1); // of groups that took no part
            rows.push_back(row);
        }
        return rows;
    }

  private:
    const std::string& output_;
};

std::string boxText(const Box& b) {
    return fmt::format("{} {} {} {} {} {}", digits(b.lo.x), digits(b.lo.y), digits(b.lo.z), digits(b.hi.x),
                       digits(b.hi.y), digits(b.hi.z));
}
const std::string boxPattern = R"(\(# # #\) \(# # #\))";

void statistics(Comparison& c, const QualityReport& r) {
    const MeshStatistics& s = r.statistics;
    c.same("\\n points: #", r.points);
    c.same("\\n faces: #", r.faces);
    c.same("internal faces: #", r.internalFaces);
    c.same("\\n cells: #", r.cells);
    c.same("faces per cell: #", double(r.faces + r.internalFaces) / double(r.cells));
    c.same("boundary patches: #", r.patches.size());
    c.same("cell zones: #", r.zones.size());
    EXPECT_EQ(c.says("internal points: #"), s.internalPoints >= 0);
    if (s.internalPoints >= 0) {
        c.same("internal points: #", s.internalPoints);
        c.same("\\n edges: #", s.edges);
        c.same("internal edges: #", s.internalEdges);
        c.same("using one boundary point: #", s.internalEdgesOnePoint);
        c.same("using two boundary points: #", s.internalEdgesTwoPoints);
    }
    c.same("hexahedra: #", s.hexahedra);
    c.same("prisms: #", s.prisms);
    c.same("\\n wedges: #", s.wedges);
    c.same("pyramids: #", s.pyramids);
    c.same("tet wedges: #", s.tetWedges);
    c.same("tetrahedra: #", s.tetrahedra);
    c.same("polyhedra: #", s.polyhedra);
    Rows byFaces;
    for (const auto& [faces, cells] : s.polyhedraByFaces)
        byFaces.push_back(fmt::format("{} {}", faces, cells));
    EXPECT_THAT(byFaces, ElementsAreArray(c.all(R"(\n[ \t]+# #)", "Breakdown of polyhedra", "\n\n")));
}

const char* kindOfSurface(SurfaceTopology topology) {
    switch (topology) {
    case SurfaceTopology::empty:
        return "(empty)";
    case SurfaceTopology::closed:
        return "(closed";
    case SurfaceTopology::sharedPoint:
        return "(shared point)";
    case SurfaceTopology::open:
        return "(non-closed";
    case SurfaceTopology::sharedEdge:
        return "(shared edge)";
    }
    return "";
}

void parts(Comparison& c, const QualityReport& r) {
    Rows patches, zones, regions;
    for (const PatchQuality& p : r.patches) {
        patches.push_back(fmt::format("{} {} {} {}", p.name, p.faces, p.points, kindOfSurface(p.topology)));
        if (p.points > 0) patches.back() += " " + boxText(p.box);
    }
    const Rows theirs = c.all(R"(\n *(\S+) # # (?:ok|multiply connected) )"
                              R"((\(empty\)|\(closed|\(shared point\)|\(non-closed|\(shared edge\))[^(\n]*)"
                              "(?:" +
                                  boxPattern + ")?",
                              "Checking patch topology", "Checking faceZone");
    EXPECT_THAT(patches, ElementsAreArray(theirs));
    for (const ZoneQuality& z : r.zones)
        zones.push_back(
            fmt::format("{} {} {} {} {}", z.name, z.cells, z.points, digits(z.volume), boxText(z.box)));
    EXPECT_THAT(zones, ElementsAreArray(c.all(R"(\n *(\S+) # # # )" + boxPattern, "basic cellZone addressing",
                                              "Checking geometry")));
    c.same("Number of regions: #", r.regions.size());
    for (std::size_t i = 0; r.regions.size() > 1 && i < r.regions.size(); ++i)
        regions.push_back(fmt::format("{} {} {}", i, r.regions[i].pointConnected ? "point" : "fully",
                                      digits(double(r.regions[i].cells))));
    EXPECT_THAT(regions, ElementsAreArray(c.all(R"(region # \((point|fully) \w+\) with # cells)")));
}

void topology(Comparison& c, const QualityReport& r) {
    EXPECT_EQ(c.says("Boundary definition OK"), r.boundaryDefined);
    EXPECT_EQ(c.says("empty patches is not divisible"), !r.emptyFacesDivide);
    EXPECT_EQ(c.says("not in upper triangular order"), !r.upperTriangular);
    c.sameCount("number unused by faces: #", r.unusedPoints);
    c.sameCount("Found # neighbouring cells with multiple", r.multiplyConnectedCells);
    c.sameCount("invalid vertex labels found, number of faces: #", r.faultyFaceVertices);
    c.sameCount("Open cells found, number of cells: #", r.openCellsByEdges);
    c.sameCount(R"(\(baffle faces\): #)", r.baffleFaces);
    c.sameCount(R"(duplicate \(not baffle\) faces found: #)", r.duplicateFaces);
    c.sameCount("non-consecutive shared points: #", r.nonConsecutiveFaces);
}

void directions(Comparison& c, const QualityReport& r) {
    const auto three = [&](const char* text, const std::array<int, 3>& d) {
        c.same(text, std::int64_t(d[0] + d[1] + d[2]), std::int64_t(d[0]), std::int64_t(d[1]),
               std::int64_t(d[2]));
    };
    three(R"(has # geometric [^\n]*directions \(# # #\))", r.geometricDirections);
    three(R"(has # solution [^\n]*directions \(# # #\))", r.solutionDirections);
    Rows wedges;
    for (const WedgeQuality& w : r.wedges) wedges.push_back(w.name + " " + digits(w.angle));
    EXPECT_THAT(wedges, ElementsAreArray(c.all(R"(Wedge (\S+) with angle #)")));
    c.sameCount("Number of edges not aligned with[^:]*: #", r.misalignedEdges);
}

void geometry(Comparison& c, const QualityReport& r) {
    c.same("Overall domain bounding box " + boxPattern, r.box.lo.x, r.box.lo.y, r.box.lo.z, r.box.hi.x,
           r.box.hi.y, r.box.hi.z);
    const Vec3& open = r.boundaryOpenness;
    c.same(R"(Boundary openness \(# # #\))", open.x, open.y, open.z);
    // Of open cells nothing more is said; of high ratios no openness.
    c.sameCount("number of open cells #", r.openCells);
    if (r.openCells > 0 || r.highAspectRatioCells == 0)
        c.same("(?:M|m)ax cell openness(?::| =) #", r.maxOpenness);
    if (r.openCells == 0) {
        c.same("Max aspect ratio(?::| =) #", r.maxAspectRatio);
        c.sameCount("Max aspect ratio: [^,\\n]*, number of cells #", r.highAspectRatioCells);
    }
    c.same("Minimum (?:face )?area(?::| =) #", r.minFaceArea);
    if (findCheck(r, "zeroAreaFaces") == nullptr) c.same("Maximum face area = #", r.maxFaceArea);
    c.same("Min(?:imum negative)? volume(?::| =) #", r.minVolume);
    c.sameCount("Number of negative volume cells: #", r.negativeVolumeCells);
    if (r.negativeVolumeCells == 0)
        c.same(R"(Max volume = #\. Total volume = #)", r.maxVolume, r.totalVolume);
    if (r.internalFaces > 0)
        c.same("non-orthogonality Max: # average: #", r.maxNonOrthogonality, r.meanNonOrthogonality);
    c.sameCount(R"(severely non-orthogonal \(> 70 degrees\) faces: #)", r.severeNonOrthogonalFaces);
    c.sameCount("non-orthogonality errors: #", r.nonOrthogonalityErrors);
    c.sameCount("face pyramids: # faces", r.wrongOrientedFaces);
    c.same("Max skewness = #", r.maxSkewness);
    c.sameCount("# highly skew faces", r.highlySkewFaces);
}

void extended(Comparison& c, const QualityReport& r) {
    c.sameCount("face tets: # faces", r.tetErrors);
    c.same("(?:m|M)in/max edge length = # #", r.minEdgeLength, r.maxEdgeLength);
    c.sameCount("number too small: #", r.shortEdgePoints);
    if (findCheck(r, "nearPoints") != nullptr) c.same(R"(near \(closer than # apart\))", r.nearDistance);
    c.sameCount("# faces with concave angles between", r.concaveFaces);
    if (r.concaveFaces > 0) c.same("Max concave angle = #", r.maxConcaveAngle);
    if (r.flatnessFaces > 0) c.same("min = # average = #", r.minFaceFlatness, r.meanFaceFlatness);
    c.sameCount("# faces with ratio between", r.warpedFaces);
    c.same(R"(\(wellposedness\) : minimum: # average: #)", r.minDeterminant, r.meanDeterminant);
    c.sameCount(R"(small determinant \([^)]*\) found, number of cells: #)", r.smallDeterminantCells);
    c.sameCount(R"(Concave cells [^,]*, number of cells: #)", r.concaveCells);
    if (r.internalFaces > 0) {
        c.same("interpolation weight : minimum: # average: #", r.minFaceWeight, r.meanFaceWeight);
        c.same("volume ratio : minimum: # average: #", r.minVolumeRatio, r.meanVolumeRatio);
    }
    c.sameCount(R"(small interpolation weight \([^)]*\) found, number of faces: #)", r.lowWeightFaces);
    c.sameCount(R"(small volume ratio \([^)]*\) found, number of faces: #)", r.lowVolumeRatioFaces);
}

// The sets it writes, in its order, and the verdict.
void setsAndVerdict(Comparison& c, const QualityReport& r) {
    Rows checks;
    for (const QualityCheck& check : r.checks)
        checks.push_back(fmt::format("{} {}", check.count, check.name));
    EXPECT_THAT(checks, ElementsAreArray(c.all(R"(Writing # [^\n]* to set (\w+))")));
    EXPECT_EQ(c.says(R"(Mesh OK\.)"), r.ok());
    c.sameCount("Failed # mesh checks", r.failedChecks);
}

} // namespace

void compareWithCheckMesh(const std::string& output, const QualityReport& report) {
    const std::size_t begin = output.find("Mesh stats");
    ASSERT_NE(begin, std::string::npos) << output;
    // In the middle of a patch's row checkMesh tells of each pinched point and the faces around it.
    static const std::regex pinched(
        "Point [0-9]+ uses faces[^\n]*\nThis means[^:]*:\n([ 0-9]+\n)*\nUnconnected[^:]*:\n([ 0-9]+\n)*");
    const std::string text = std::regex_replace(output.substr(begin), pinched, "");
    Comparison c(text);
    statistics(c, report);
    parts(c, report);
    topology(c, report);
    directions(c, report);
    geometry(c, report);
    extended(c, report);
    setsAndVerdict(c, report);
}

void compareWithMeshQuality(const std::string& output, const QualityReport& report) {
    const std::size_t begin = output.find("Checking faces in error");
    ASSERT_NE(begin, std::string::npos) << output;
    const std::string text = output.substr(begin);
    const std::pair<const char*, const char*> lines[] = {{"maxNonOrtho", "non-orthogonality >"},
                                                         {"minVol", "face pyramid volume <"},
                                                         {"minTetQuality", "face-decomposition tet quality <"},
                                                         {"maxConcave", "faces with concavity >"},
                                                         {"minArea", "faces with area <"},
                                                         {"maxInternalSkewness", "faces with skewness >"},
                                                         {"minFaceWeight", "faces with interpolation weights"},
                                                         {"minVolRatio", "faces with volume ratio of neighbour cells <"},
                                                         {"minTwist", "faces with face twist <"},
                                                         {"minTriangleTwist", "faces with triangle twist <"},
                                                         {"minFaceFlatness", "faces with flatness <"},
                                                         {"minDeterminant", "faces on cells with determinant <"}};
    Rows ours, theirs;
    for (const auto& [key, words] : lines) {
        const auto check = std::find_if(report.dictionary.begin(), report.dictionary.end(), [&, k = key](const auto& c) { return c.key == k; });
        ASSERT_NE(check, report.dictionary.end()) << key;
        std::int64_t faces = check->newFaces;
        if (check->key == "maxInternalSkewness") faces += std::next(check)->newFaces; // those of the boundary, in one line
        if (check->asked) ours.push_back(fmt::format("{} {}", key, faces));
        std::smatch match;
        if (std::regex_search(text, match, std::regex(std::string(words) + "[^\n]*: (\\d+)\n")))
            theirs.push_back(fmt::format("{} {}", key, match[1].str()));
    }
    EXPECT_THAT(ours, ElementsAreArray(theirs));
    Comparison(text).sameCount("Writing # faces in error to set meshQualityFaces", report.dictionaryFaces);
}

} // namespace i2b::test
