#include "pipeline/stages_run.h"
#include "i2b/geometry/rims.h"
#include "i2b/carve/carve.h"
#include "i2b/front/replace_faces.h"
#include <numbers>
#include <random>

namespace i2b::test {
namespace {

const Vec3 half{1, 0.8, 0.6};           // m, of the boxes
const Vec3 plateHalf{0.65, 0.45, 0.2};  // m, of plateInTop()
constexpr double plateTurn = 0.13;      // radians
constexpr double borderX0 = 0.03, borderX1 = 0.31; // m, of flushHalves() at the low and the high end in y

// Core points that several vertices of the front share.
std::vector<bool> sharedPoints(const Front& front) {
    std::vector<int> fans(static_cast<std::size_t>(front.corePoints), 0);
    for (const std::int32_t p : front.corePoint) ++fans[static_cast<std::size_t>(p)];
    std::vector<bool> shared;
    for (const std::int32_t p : front.corePoint) shared.push_back(fans[static_cast<std::size_t>(p)] > 1);
    return shared;
}

void addInserted(Front& front, std::int32_t p, std::int32_t q, double t) {
    const auto a = static_cast<std::size_t>(p), b = static_cast<std::size_t>(q);
    const Vec3 wall = wallPoint(front, a) + (wallPoint(front, b) - wallPoint(front, a)) * t;
    front.mesh.add_vertex({wall.x, wall.y, wall.z});
    front.corePoint.push_back(front.corePoints + static_cast<std::int32_t>(front.inserted.size()));
    front.front.push_back(Front::Inserted{{p, q}, t}.frontAt(front.front[a], front.front[b], wall));
    front.h.push_back(std::min(front.h[a], front.h[b]));
    front.size.push_back(cwiseMin(front.size[a], front.size[b]));
    front.inside.push_back(front.inside[a] + (front.inside[b] - front.inside[a]) * t);
    front.direction.push_back(front.direction[a]);
    front.outside.push_back(front.outside[a] & front.outside[b]);
    front.inserted.push_back({{p, q}, t});
}

// Not all on one straight edge of a lattice face. Vertices put into edges stand off them by their lift.
bool hasArea(const Front& front, const std::vector<std::int32_t>& polygon) {
    const auto onEdge = [&](std::int32_t v) {
        const auto i = static_cast<std::size_t>(v);
        if (i < front.firstInserted()) return front.front[i];
        const Front::Inserted& inserted = front.inserted[i - front.firstInserted()];
        const Vec3 &a = front.front[static_cast<std::size_t>(inserted.ends[0])], &b = front.front[static_cast<std::size_t>(inserted.ends[1])];
        return a + (b - a) * inserted.t;
    };
    Vec3 area;
    const Vec3 o = onEdge(polygon[0]);
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i) area += cross(onEdge(polygon[i]) - o, onEdge(polygon[i + 1]) - o);
    const double h = front.h[static_cast<std::size_t>(polygon[0])];
    return norm(area) > 1e-3 * h * h;
}

} // namespace

void addPart(Surface& soup, const samples::Mesh& mesh, const char* name) {
    const auto first = static_cast<std::uint32_t>(soup.points.size());
    soup.points.insert(soup.points.end(), mesh.points.begin(), mesh.points.end());
    for (const auto& t : mesh.triangles) {
        soup.triangles.push_back({first + t[0], first + t[1], first + t[2]});
        soup.partOf.push_back(static_cast<std::int32_t>(soup.parts.size()));
    }
    soup.parts.push_back({name, "", mesh.triangles.size()});
}

Options stagesOptions() {
    Options options;
    options.size.surface = stagesSize;
    options.size.max = 4 * stagesSize;
    options.domain.box = Box{{-2.4, -2.4, -2.4}, {2.4, 2.4, 2.4}};
    options.domain.flow = Flow::external;
    return options;
}

Surface turnedBox() {
    samples::Mesh mesh = samples::box(-half, half);
    const double a = 0.41, b = 0.27, c = 0.63;
    for (Vec3& p : mesh.points) {
        p = {p.x * std::cos(a) - p.y * std::sin(a), p.x * std::sin(a) + p.y * std::cos(a), p.z};
        p = {p.x, p.y * std::cos(b) - p.z * std::sin(b), p.y * std::sin(b) + p.z * std::cos(b)};
        p = {p.x * std::cos(c) + p.z * std::sin(c), p.y, p.z * std::cos(c) - p.x * std::sin(c)};
    }
    Surface soup;
    addPart(soup, mesh, "box");
    return soup;
}

double borderSide(const Vec3& p) {
    const Vec3 along = normalized(Vec3{borderX1 - borderX0, 2 * half.y, 0});
    return cross(along, p - Vec3{borderX0, -half.y, 0}).z;
}

Surface flushHalves() {
    const samples::Frame frame = samples::upright({0, 0, -half.z});
    const auto onBorder = [](const Vec3& centre, const Vec3&) { return std::abs(borderSide(centre)) < 1e-9; };
    const samples::Loop2 outline{{-half.x, -half.y}, {borderX0, -half.y}, {borderX1, half.y}, {-half.x, half.y}};
    samples::Mesh left = samples::extrude(frame, outline, {}, {0, 2 * half.z});
    const samples::Loop2 other{{borderX0, -half.y}, {half.x, -half.y}, {half.x, half.y}, {borderX1, half.y}};
    samples::Mesh right = samples::extrude(frame, other, {}, {0, 2 * half.z});
    samples::drop(left, onBorder);
    samples::drop(right, onBorder);
    Surface soup;
    addPart(soup, left, "left");
    addPart(soup, right, "right");
    return soup;
}

namespace {

Vec3 turned(const Vec3& p) { return {p.x * std::cos(plateTurn) - p.y * std::sin(plateTurn), p.x * std::sin(plateTurn) + p.y * std::cos(plateTurn), p.z}; }

// Of a rectangle with this half at the height of the block's top.
std::array<Vec3, 4> turnedOutline(const Vec3& of) {
    return {turned({-of.x, -of.y, half.z}), turned({of.x, -of.y, half.z}), turned({of.x, of.y, half.z}), turned({-of.x, of.y, half.z})};
}

} // namespace

Surface plateInTop(double rise, double depth) {
    samples::Mesh plate = samples::box({-plateHalf.x, -plateHalf.y, -depth}, {plateHalf.x, plateHalf.y, rise});
    for (Vec3& p : plate.points) p = turned(p) + Vec3{0, 0, half.z};
    Surface soup;
    addPart(soup, samples::box(-half, half), "block");
    addPart(soup, plate, "plate");
    return soup;
}

std::array<Vec3, 4> plateFoot() { return turnedOutline(plateHalf); }

Surface lidOnTop(double over) {
    samples::Mesh block = samples::box(-half, half), lid = samples::box({-half.x - over, -half.y - over, half.z}, {half.x + over, half.y + over, half.z + 0.4});
    for (samples::Mesh* mesh : {&block, &lid})
        for (Vec3& p : mesh->points) p = turned(p);
    Surface soup;
    addPart(soup, block, "block");
    addPart(soup, lid, "lid");
    return soup;
}

Surface bentBack(double strip) {
    const double degree = 3.14159265358979323846 / 180, x = 0.03, rest = half.x + x - strip;
    const double z = half.z + strip * std::tan(45 * degree), top = z + rest * std::tan(10 * degree);
    const samples::Loop2 outline{{-half.x, -half.z}, {half.x, -half.z}, {half.x, half.z}, {x, half.z}, {x - strip, z}, {-half.x, top}};
    samples::Mesh block = samples::extrude(samples::upright({0, 0, -half.y}), outline, {}, {0, 2 * half.y});
    for (Vec3& p : block.points) p = {p.x, -p.z, p.y};
    Surface soup;
    addPart(soup, block, "block");
    return soup;
}

std::array<Vec3, 2> bentBackLine() { return {Vec3{0.03, -half.y, half.z}, Vec3{0.03, half.y, half.z}}; }

std::array<Vec3, 4> lidFoot() { return turnedOutline(half); }

namespace {

// As generate() has them.
FeatureGraph sharpLinesOf(const Painted& painted) {
    FeatureGraph graph = buildFeatureGraph(painted.soup, {});
    markRims(graph, *painted.index, {}, 2 * stagesSize);
    return graph;
}

} // namespace

ToFront::ToFront(const Surface& soup, const Options& options)
    : painted(RandomCase{"", soup, options}), kept(carve(painted.grid, painted.cut, painted.regions, *painted.index, options.fit)),
      lattice(painted.grid, kept), front(buildFront(lattice, startThickness)), graph(sharpLinesOf(painted)), features(graph) {}

ToMesh::ToMesh(const Surface& soup, const Options& options) : ToFront(soup, options) {
    const Context context;
    fitted = fitFront(front, lattice, *painted.index, graph, options.fit, context);
    assignParts(front, *painted.index);
    layers = makeLayers(front, options.layers);
    mesh = assemble({lattice, kept, front, layers, painted.soup.parts});
}

Vec3 wallPoint(const Front& front, std::size_t vertex) {
    const auto& p = front.mesh.point(FrontMesh::VertexHandle(static_cast<int>(vertex)));
    return {p[0], p[1], p[2]};
}

void divideAtRandom(Front& front, unsigned seed, double share) {
    std::mt19937 random(seed);
    const auto real = [&] { return static_cast<double>(random()) / 4294967296.0; };
    const std::vector<bool> shared = sharedPoints(front);
    std::vector<std::int32_t> vertexOn(front.mesh.n_edges(), -1);
    for (auto e : front.mesh.edges()) {
        const auto he = front.mesh.halfedge_handle(e, 0);
        const std::int32_t p = front.mesh.from_vertex_handle(he).idx(), q = front.mesh.to_vertex_handle(he).idx();
        const auto a = static_cast<std::size_t>(p), b = static_cast<std::size_t>(q);
        const bool divides = real() < share;
        const double t = 0.2 + 0.6 * real();
        if (!divides || (shared[a] && shared[b]) || (front.outside[a] & front.outside[b]) != 0) continue;
        vertexOn[static_cast<std::size_t>(e.idx())] = static_cast<std::int32_t>(front.front.size());
        addInserted(front, p, q, t);
    }
    std::vector<FaceCut> cuts;
    for (auto f : front.mesh.faces()) {
        std::vector<std::int32_t> ring;
        std::vector<std::size_t> added;
        for (auto he : front.mesh.fh_range(f)) {
            ring.push_back(front.mesh.from_vertex_handle(he).idx());
            const std::int32_t v = vertexOn[static_cast<std::size_t>(front.mesh.edge_handle(he).idx())];
            if (v >= 0) added.push_back(ring.size()), ring.push_back(v);
        }
        if (added.empty()) continue;
        FaceCut& cut = cuts.emplace_back(FaceCut{f.idx(), {ring}});
        if (added.size() < 2) continue;
        const auto from = ring.begin() + static_cast<std::ptrdiff_t>(added[0]), to = ring.begin() + static_cast<std::ptrdiff_t>(added[1]);
        std::vector<std::int32_t> one(from, to + 1), other(to, ring.end());
        other.insert(other.end(), ring.begin(), from + 1);
        if (hasArea(front, one) && hasArea(front, other)) cut.polygons = {one, other};
    }
    replaceFaces(front, cuts);
}

} // namespace i2b::test
