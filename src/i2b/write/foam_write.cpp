#include "i2b/write/foam_write.h"
#include "i2b/core/error.h"
#include "i2b/write/foam_dictionaries.h"
#include "i2b/write/output_file.h"
#include <bit>
#include <cctype>
#include <charconv>
#include <fmt/format.h>
#include <set>
#include <tbb/parallel_invoke.h>

namespace i2b {
namespace {

static_assert(std::endian::native == std::endian::little, "the files say LSB");
static_assert(sizeof(Vec3) == 3 * sizeof(double), "points are written as they lie in memory");

constexpr const char* location = "constant/polyMesh";
constexpr std::size_t block = 16384; // items formatted at a time: some hundred kB of text

// Grows the string for the largest text an item can have, then cuts it: no check a digit.
class TextCursor {
  public:
    TextCursor(std::string& out, std::size_t most) : out_(out) {
        out_.resize(most);
        at_ = out_.data();
        end_ = at_ + most;
    }
    ~TextCursor() { out_.resize(static_cast<std::size_t>(at_ - out_.data())); }
    void put(char c) { *at_++ = c; }
    template <class T>
    void number(T value) {
        at_ = std::to_chars(at_, end_, value).ptr;
    }

  private:
    std::string& out_;
    char *at_ = nullptr, *end_ = nullptr;
};

struct FoamWriter {
    const PolyMesh& mesh;
    const std::filesystem::path& folder;
    const FoamWriteOptions& options;
    const Context& context;

    bool binary() const { return !options.ascii; }

    void points() const;
    void faces() const;
    void labels(const char* object, std::span<const std::int32_t> values) const;
    void boundary() const;
    void cellZones() const;

    void labelList(OutputFile& file, std::span<const std::int32_t> values) const;
    void compactFaces(OutputFile& file) const;
    void textFaces(OutputFile& file) const;
};

void FoamWriter::points() const {
    const std::size_t n = mesh.points.size();
    OutputFile file(folder / "points", binary() ? 24 * n + 400 : 0);
    file.write(foamHeader("vectorField", location, "points", binary(), options.note));
    file.write(fmt::format("{}\n(", n));
    if (binary()) {
        writeArray(file, std::span<const Vec3>(mesh.points), context);
    } else {
        file.write("\n");
        const auto format = [&](std::size_t begin, std::size_t end, std::string& out) {
            TextCursor text(out, (end - begin) * 80);
            for (std::size_t i = begin; i < end; ++i) {
                const Vec3& p = mesh.points[i];
                text.put('('), text.number(p.x), text.put(' '), text.number(p.y), text.put(' '),
                    text.number(p.z);
                text.put(')'), text.put('\n');
            }
        };
        writeBlocks(file, n, block, format, context);
    }
    file.write(")\n");
    file.close();
}

void FoamWriter::labelList(OutputFile& file, std::span<const std::int32_t> values) const {
    file.write(fmt::format("{}\n(", values.size()));
    if (binary()) {
        writeArray(file, values, context);
    } else {
        file.write("\n");
        const auto format = [&](std::size_t begin, std::size_t end, std::string& out) {
            TextCursor text(out, (end - begin) * 12);
            for (std::size_t i = begin; i < end; ++i) text.number(values[i]), text.put('\n');
        };
        writeBlocks(file, values.size(), 4 * block, format, context);
    }
    file.write(")\n");
}

void FoamWriter::compactFaces(OutputFile& file) const {
    file.write(fmt::format("{}\n(", mesh.faceOffsets.size()));
    writeArray(file, std::span<const std::uint32_t>(mesh.faceOffsets),
               context); // below 2^31: same bytes as labels
    file.write(fmt::format(")\n\n{}\n(", mesh.faceVertices.size()));
    writeArray(file, std::span<const std::int32_t>(mesh.faceVertices), context);
    file.write(")\n");
}

void FoamWriter::textFaces(OutputFile& file) const {
    file.write(fmt::format("{}\n(\n", mesh.faces()));
    const auto format = [&](std::size_t begin, std::size_t end, std::string& out) {
        const std::size_t vertices = mesh.faceOffsets[end] - mesh.faceOffsets[begin];
        TextCursor text(out, vertices * 12 + (end - begin) * 14);
        for (std::size_t f = begin; f < end; ++f) {
            const auto face = mesh.face(static_cast<std::int32_t>(f));
            text.number(face.size());
            char separator = '(';
            for (const std::int32_t v : face) text.put(separator), text.number(v), separator = ' ';
            text.put(')'), text.put('\n');
        }
    };
    writeBlocks(file, static_cast<std::size_t>(mesh.faces()), block, format, context);
    file.write(")\n");
}

void FoamWriter::faces() const {
    OutputFile file(folder / "faces",
                    binary() ? 4 * (mesh.faceOffsets.size() + mesh.faceVertices.size()) + 400 : 0);
    file.write(
        foamHeader(binary() ? "faceCompactList" : "faceList", location, "faces", binary(), options.note));
    if (binary())
        compactFaces(file);
    else
        textFaces(file);
    file.close();
}

void FoamWriter::labels(const char* object, std::span<const std::int32_t> values) const {
    OutputFile file(folder / object, binary() ? 4 * values.size() + 400 : 0);
    // Decomposing and converting tools read these counts instead of the points and faces.
    const std::string note = fmt::format("nPoints:{}  nCells:{}  nFaces:{}  nInternalFaces:{}",
                                         mesh.points.size(), mesh.cells, mesh.faces(), mesh.internalFaces());
    file.write(foamHeader("labelList", location, object, binary(), note));
    labelList(file, values);
    file.close();
}

// Always text: it is the file that users edit.
void FoamWriter::boundary() const {
    std::vector<std::string> names;
    for (const Patch& patch : mesh.patches) names.push_back(patch.name);
    names = foamNames(names);
    OutputFile file(folder / "boundary");
    file.write(foamHeader("polyBoundaryMesh", location, "boundary", false, options.note));
    file.write(fmt::format("{}\n(\n", mesh.patches.size()));
    for (std::size_t i = 0; i < names.size(); ++i) {
        const Patch& patch = mesh.patches[i];
        file.write(fmt::format("    {}\n    {{\n        type            {};\n", names[i], patch.type));
        if (patch.type != "patch") file.write(fmt::format("        inGroups        1({});\n", patch.type));
        file.write(fmt::format("        nFaces          {};\n        startFace       {};\n    }}\n",
                               patch.count, patch.start));
    }
    file.write(")\n");
    file.close();
}

void FoamWriter::cellZones() const {
    std::vector<std::string> names;
    for (const CellZone& zone : mesh.zones) names.push_back(zone.name);
    names = foamNames(names);
    OutputFile file(folder / "cellZones");
    file.write(foamHeader("regIOobject", location, "cellZones", binary(), options.note));
    file.write(fmt::format("{}\n(\n", names.size()));
    for (std::size_t i = 0; i < names.size(); ++i) {
        file.write(fmt::format("{}\n{{\n    type            cellZone;\n    cellLabels      List<label>\n",
                               names[i]));
        if (mesh.zones[i].cells.empty())
            file.write("0()\n");
        else
            labelList(file, mesh.zones[i].cells);
        file.write("    ;\n}\n");
    }
    file.write(")\n");
    file.close();
}

void writeIfAbsent(AtomicFolder& folder, const char* relative, const std::string& text) {
    if (folder.exists(relative)) return;
    OutputFile file(folder.place(relative));
    file.write(text);
    file.close();
}

} // namespace

std::vector<std::string> foamNames(const std::vector<std::string>& names) {
    std::vector<std::string> result;
    std::set<std::string> taken;
    for (const std::string& name : names) {
        std::string word;
        for (const char c : name)
            word += std::isalnum(static_cast<unsigned char>(c)) || c == '.' || c == '-' ? c : '_';
        // A word that begins like a number would be read as one.
        if (word.empty() || !(std::isalpha(static_cast<unsigned char>(word[0])) || word[0] == '_'))
            word.insert(0, "_");
        std::string unique = word;
        for (int n = 2; !taken.insert(unique).second; ++n) unique = fmt::format("{}_{}", word, n);
        result.push_back(unique);
    }
    return result;
}

std::uint64_t foamBytes(const PolyMesh& mesh) {
    std::uint64_t labels =
        mesh.faceOffsets.size() + mesh.faceVertices.size() + mesh.owner.size() + mesh.neighbour.size();
    for (const CellZone& zone : mesh.zones) labels += zone.cells.size();
    return 24 * mesh.points.size() + 4 * labels;
}

void writeFoam(const PolyMesh& mesh, AtomicFolder& folder, const FoamWriteOptions& options,
               const Context& context) {
    constexpr std::uint64_t most = 0x7fffffff;
    if (mesh.faceVertices.size() > most || mesh.points.size() > most)
        throw Error(ErrorKind::input,
                    "the mesh has more than 2^31 face vertices, which 32-bit labels cannot count",
                    folder.target().string(), "choose a larger --size");
    const std::filesystem::path place = folder.placeFolder(location);
    const FoamWriter writer{mesh, place, options, context};
    // Most of what binary files cost is the kernel's copy of them.
    tbb::parallel_invoke([&] { writer.points(); }, [&] { writer.faces(); }, [&] { writer.labels("owner", mesh.owner); },
                         [&] { writer.labels("neighbour", mesh.neighbour); });
    writer.boundary();
    if (!mesh.zones.empty()) writer.cellZones();
    if (!options.caseFiles) return;
    writeIfAbsent(folder, "system/controlDict", controlDictText(options.note));
    writeIfAbsent(folder, "system/fvSchemes", fvSchemesText(options.note));
    writeIfAbsent(folder, "system/fvSolution", fvSolutionText(options.note));
    writeIfAbsent(folder, "case.foam", "");
}

} // namespace i2b
