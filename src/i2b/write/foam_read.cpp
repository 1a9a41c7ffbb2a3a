#include "i2b/write/foam_read.h"
#include "i2b/core/error.h"
#include "i2b/core/parallel.h"
#include "i2b/write/foam_scan.h"
#include <algorithm>
#include <exception>
#include <filesystem>
#include <fmt/format.h>
#include <functional>
#include <optional>

namespace i2b {
namespace {

namespace fs = std::filesystem;
using Index = std::size_t;

std::optional<std::string> findFile(const fs::path& folder, const char* name) {
    for (const fs::path& path : {folder / name, folder / (std::string(name) + ".gz")})
        if (fs::is_regular_file(path)) return path.string();
    return std::nullopt;
}

fs::path meshFolder(const std::string& folder) {
    for (const fs::path& path :
         {fs::path(folder), fs::path(folder) / "polyMesh", fs::path(folder) / "constant/polyMesh"})
        if (findFile(path, "points") && findFile(path, "faces")) return path;
    throw Error(ErrorKind::input,
                "there is no OpenFOAM mesh (files points, faces, owner, neighbour, boundary)", folder,
                "name a case folder with constant/polyMesh, or the polyMesh folder itself");
}

std::string requireFile(const fs::path& folder, const char* name) {
    if (auto file = findFile(folder, name)) return *file;
    throw Error(ErrorKind::input, fmt::format("the file {} is missing", name), folder.string(),
                "an OpenFOAM mesh has points, faces, owner, neighbour and boundary");
}

template <class Test>
bool allOf(Index n, const Test& test) {
    return orderedReduce(
        n, true,
        [&](Index begin, Index end) {
            bool all = true;
            for (Index i = begin; i < end; ++i) all &= test(i);
            return all;
        },
        [](bool a, bool b) { return a && b; }, 1 << 16);
}

RawVector<std::int32_t> readLabels(const std::string& path) {
    const MappedFile file(path);
    return FoamScanner(file).labels();
}

void readFaces(const std::string& path, PolyMesh& mesh) {
    const MappedFile file(path);
    FoamScanner scan(file);
    if (scan.header().type == "faceCompactList") {
        mesh.faceOffsets = scan.offsets();
        if (mesh.faceOffsets.empty()) mesh.faceOffsets.push_back(0);
        mesh.faceVertices = scan.labels();
    } else {
        const std::int64_t faces = scan.integer();
        if (faces < 0 || static_cast<Index>(faces) > file.bytes().size())
            scan.fail(fmt::format("a list of {} faces cannot be in this file", faces));
        mesh.faceOffsets.reserve(Index(faces) + 1);
        mesh.faceOffsets.push_back(0);
        mesh.faceVertices.reserve(Index(faces) * 4);
        if (faces > 0 || scan.peek() == "(") scan.expect("(");
        for (std::int64_t f = 0; f < faces; ++f) {
            scan.appendLabels(mesh.faceVertices);
            mesh.faceOffsets.push_back(static_cast<std::uint32_t>(mesh.faceVertices.size()));
        }
    }
    const bool ordered = allOf(mesh.faceOffsets.size() - 1, [&](Index f) { return mesh.faceOffsets[f] <= mesh.faceOffsets[f + 1]; });
    if (!ordered || mesh.faceOffsets.front() != 0 || mesh.faceOffsets.back() != mesh.faceVertices.size())
        scan.fail("the faces' offsets do not fit their vertices");
}

// A value up to its semicolon, however deep its brackets go.
void skipValue(FoamScanner& scan) {
    int depth = 0;
    for (;;) {
        const std::string_view token = scan.next();
        if (token == "(" || token == "{") ++depth;
        if (token == ")" || token == "}") --depth;
        if (depth == 0 && (token == ";" || token == "}")) return;
    }
}

std::vector<Patch> readBoundary(const std::string& path) {
    const MappedFile file(path);
    FoamScanner scan(file);
    std::vector<Patch> patches;
    const std::int64_t count = scan.integer();
    scan.expect("(");
    while (scan.peek() != ")") {
        Patch patch;
        patch.name = std::string(scan.next());
        scan.expect("{");
        while (scan.peek() != "}") {
            const std::string_view key = scan.next();
            if (key == "type")
                patch.type = std::string(scan.next()), scan.expect(";");
            else if (key == "nFaces")
                patch.count = static_cast<std::int32_t>(scan.integer()), scan.expect(";");
            else if (key == "startFace")
                patch.start = static_cast<std::int32_t>(scan.integer()), scan.expect(";");
            else
                skipValue(scan);
        }
        scan.expect("}");
        patches.push_back(std::move(patch));
    }
    if (static_cast<std::int64_t>(patches.size()) != count)
        scan.fail(fmt::format("{} patches announced, {} found", count, patches.size()));
    return patches;
}

std::vector<CellZone> readZones(const std::string& path) {
    const MappedFile file(path);
    FoamScanner scan(file);
    std::vector<CellZone> zones;
    const std::int64_t count = scan.integer();
    if (count == 0) return zones;
    scan.expect("(");
    while (scan.peek() != ")") {
        CellZone zone;
        zone.name = std::string(scan.next());
        scan.expect("{");
        while (scan.peek() != "}") {
            if (scan.next() != "cellLabels") {
                skipValue(scan);
                continue;
            }
            if (scan.peek().starts_with("List")) scan.next();
            zone.cells = scan.labels();
            scan.expect(";");
        }
        scan.expect("}");
        std::sort(zone.cells.begin(), zone.cells.end());
        zones.push_back(std::move(zone));
    }
    return zones;
}

// All at once. Of several that fail the first one's complaint counts, whichever comes first by the clock.
void inParallel(const std::vector<std::function<void()>>& tasks) {
    std::vector<std::exception_ptr> failures(tasks.size());
    parallelFor(
        tasks.size(),
        [&](Index i) {
            try {
                tasks[i]();
            } catch (...) {
                failures[i] = std::current_exception();
            }
        },
        1);
    for (const std::exception_ptr& failure : failures)
        if (failure) std::rethrow_exception(failure);
}

std::int32_t highest(std::span<const std::int32_t> cells) { // -1 of none
    return orderedReduce(
        cells.size(), std::int32_t(-1),
        [&](Index begin, Index end) { return std::max(-1, *std::max_element(cells.begin() + std::ptrdiff_t(begin), cells.begin() + std::ptrdiff_t(end))); },
        [](std::int32_t a, std::int32_t b) { return std::max(a, b); }, 1 << 16);
}

// What the rest of the program relies on before it looks at anything else.
void checkRanges(const PolyMesh& mesh, const std::string& folder) {
    const auto fail = [&](const std::string& what) {
        throw Error(ErrorKind::input, what, folder,
                    "the files of the mesh do not belong together; write it again");
    };
    const Index faces = mesh.owner.size();
    if (mesh.faceOffsets.size() != faces + 1)
        fail(fmt::format("{} faces, but {} owners", mesh.faceOffsets.size() - 1, faces));
    if (mesh.neighbour.size() > faces)
        fail(fmt::format("{} neighbours for {} faces", mesh.neighbour.size(), faces));
    const auto hasCorners = [&](Index f) { return mesh.faceOffsets[f + 1] >= mesh.faceOffsets[f] + 3; };
    if (!allOf(faces, hasCorners)) {
        Index f = 0;
        while (hasCorners(f)) ++f;
        fail(fmt::format("face {} has fewer than 3 vertices", f));
    }
    const auto inRange = [](std::span<const std::int32_t> values, Index limit) {
        return allOf(values.size(), [&](Index i) { return values[i] >= 0 && static_cast<Index>(values[i]) < limit; });
    };
    if (!inRange(mesh.faceVertices, mesh.points.size())) fail("a face uses a point that is not there");
    if (!inRange(mesh.owner, Index(mesh.cells)) || !inRange(mesh.neighbour, Index(mesh.cells)))
        fail("a face has an owner or neighbour below zero");
    for (const Patch& patch : mesh.patches)
        if (patch.count < 0 || patch.start < 0 || Index(patch.start) + Index(patch.count) > faces)
            fail(fmt::format("patch {} has {} faces from {}, of {} faces", patch.name, patch.count,
                             patch.start, faces));
    for (const CellZone& zone : mesh.zones)
        if (!inRange(zone.cells, Index(mesh.cells)))
            fail(fmt::format("zone {} has a cell that is not there", zone.name));
}

} // namespace

PolyMesh readFoam(const std::string& folder) {
    const fs::path path = meshFolder(folder);
    PolyMesh mesh;
    const auto file = [&](const char* name) { return requireFile(path, name); };
    inParallel({[&] {
                    const MappedFile points(file("points"));
                    mesh.points = FoamScanner(points).points();
                },
                [&] { readFaces(file("faces"), mesh); },
                [&] { mesh.owner = readLabels(file("owner")); },
                [&] { mesh.neighbour = readLabels(file("neighbour")); },
                [&] { mesh.patches = readBoundary(file("boundary")); },
                [&] {
                    if (auto zones = findFile(path, "cellZones")) mesh.zones = readZones(*zones);
                }});
    // Old versions write -1 for the boundary faces.
    while (!mesh.neighbour.empty() && mesh.neighbour.back() < 0) mesh.neighbour.pop_back();
    mesh.cells = std::max(highest(mesh.owner), highest(mesh.neighbour)) + 1;
    checkRanges(mesh, path.string());
    return mesh;
}

} // namespace i2b
