#include "i2b/write/vtu_write.h"
#include "i2b/assemble/mesh_topology.h"
#include "i2b/core/error.h"
#include "i2b/core/parallel.h"
#include "i2b/write/output_file.h"
#include "i2b/write/vtu_cells.h"
#include <algorithm>
#include <bit>
#include <cstring>
#include <fmt/format.h>
#include <functional>
#include <libdeflate.h>
#include <memory>
#include <span>
#include <tbb/enumerable_thread_specific.h>

namespace i2b {
namespace {

static_assert(std::endian::native == std::endian::little, "the file says LittleEndian");

constexpr std::size_t blockBytes = std::size_t(256) << 10; // uncompressed
constexpr std::size_t offsetDigits = 20;

// One DataArray: what it is called and how any range of its elements is made, so that none is ever held
// whole.
struct Array {
    std::string attributes; // XML
    std::size_t elements = 0, elementBytes = 0;
    std::function<void(std::size_t begin, std::size_t end, char* out)> fill;
    std::uint64_t offsetField = 0; // where in the file its offset is to be written
};

template <class T>
constexpr const char* vtkType() {
    if constexpr (std::is_same_v<T, double>) return "Float64";
    if constexpr (std::is_same_v<T, float>) return "Float32";
    if constexpr (std::is_same_v<T, std::uint8_t>) return "UInt8";
    if constexpr (std::is_same_v<T, std::int32_t>) return "Int32";
    if constexpr (std::is_same_v<T, std::int64_t>) return "Int64";
}

std::string escaped(const std::string& text) {
    std::string out;
    for (const char c : text) {
        if (c == '&')
            out += "&amp;";
        else if (c == '<')
            out += "&lt;";
        else if (c == '"')
            out += "&quot;";
        else
            out += c;
    }
    return out;
}

template <class T>
std::string attributes(const std::string& name) {
    return fmt::format("type=\"{}\" Name=\"{}\"", vtkType<T>(), escaped(name));
}

// An array as it lies in memory; `values` must outlive it.
template <class T>
Array plainArray(const std::string& name, std::span<const T> values) {
    return {attributes<T>(name), values.size(), sizeof(T),
            [values](std::size_t begin, std::size_t end, char* out) {
                std::memcpy(out, values.data() + begin, (end - begin) * sizeof(T));
            }};
}

// Where lists that lie one after the other end, four bytes a list: within blocks, and where those begin.
class ListEnds {
  public:
    explicit ListEnds(std::size_t lists) : within_(lists, 0), blocks_(lists / block + 1, 0) {}
    void setLength(std::size_t list, std::size_t length) { within_[list] = static_cast<std::uint32_t>(length); }
    void sum() { // lengths to ends
        std::int64_t total = 0;
        for (std::size_t b = 0; b < blocks_.size(); ++b) {
            blocks_[b] = total;
            std::uint32_t sum = 0;
            for (std::size_t i = b * block; i < std::min(within_.size(), (b + 1) * block); ++i) within_[i] = sum += within_[i];
            total += sum;
        }
    }
    std::size_t size() const { return within_.size(); }
    std::int64_t operator[](std::size_t list) const { return blocks_[list / block] + within_[list]; }
    std::int64_t start(std::size_t list) const { return list == 0 ? 0 : (*this)[list - 1]; }
    std::int64_t back() const { return start(size()); }
    std::size_t firstBeyond(std::int64_t place) const { // list whose end is the first greater than place
        const auto at = std::upper_bound(blocks_.begin(), blocks_.end(), place);
        auto list = static_cast<std::size_t>(at - blocks_.begin() - 1) * block;
        while (list < size() && (*this)[list] <= place) ++list;
        return list;
    }

  private:
    static constexpr std::size_t block = 1024;
    std::vector<std::uint32_t> within_;
    std::vector<std::int64_t> blocks_;
};

// What is known of each cell before anything is written: its type and where its lists end.
struct CellTable {
    const Rows& faces;
    std::vector<std::uint8_t> types;
    ListEnds pointsEnd; // of its points in connectivity
    ListEnds facesEnd;  // of its face stream; the same as the cell's before unless a polyhedron
    bool polyhedra() const { return facesEnd.back() > 0; }
};

CellTable buildCellTable(const PolyMesh& mesh, const Rows& cellFaces) {
    const auto n = static_cast<std::size_t>(mesh.cells);
    CellTable table{cellFaces, std::vector<std::uint8_t>(n), ListEnds(n), ListEnds(n)};
    parallelChunks(n, 4096, [&](std::size_t begin, std::size_t end, std::size_t) {
        std::vector<std::int32_t> points;
        for (std::size_t c = begin; c < end; ++c) {
            const auto cell = static_cast<std::int32_t>(c);
            const auto faces = table.faces[cell];
            const CellShape shape = shapeOf(mesh, faces, cell);
            table.types[c] = static_cast<std::uint8_t>(shape.type);
            table.pointsEnd.setLength(c, shape.pointCount);
            if (shape.type != VtkCell::polyhedron) continue;
            cellPoints(mesh, faces, points);
            table.pointsEnd.setLength(c, points.size());
            std::size_t stream = 1;
            for (const std::int32_t f : faces) stream += 1 + mesh.face(f).size();
            table.facesEnd.setLength(c, stream);
        }
    });
    table.pointsEnd.sum();
    table.facesEnd.sum();
    return table;
}

// Elements [begin, end) of lists that lie one after the other, cell after cell: makes the lists of the cells
// that the range touches and copies what lies inside it.
template <class Make>
void fillLists(const ListEnds& ends, std::size_t begin, std::size_t end, char* out, const Make& make) {
    std::vector<std::int32_t> list;
    std::size_t c = ends.firstBeyond(static_cast<std::int64_t>(begin));
    for (std::size_t at = begin; at < end; ++c) {
        const auto first = static_cast<std::size_t>(ends.start(c)), last = static_cast<std::size_t>(ends[c]);
        if (first == last) continue;
        list.clear();
        make(static_cast<std::int32_t>(c), list);
        const std::size_t upTo = std::min(last, end);
        std::memcpy(out, list.data() + (at - first), (upTo - at) * sizeof(std::int32_t));
        out += (upTo - at) * sizeof(std::int32_t);
        at = upTo;
    }
}

Array connectivityArray(const PolyMesh& mesh, const CellTable& table) {
    const auto n = static_cast<std::size_t>(table.pointsEnd.back());
    return {attributes<std::int32_t>("connectivity"), n, sizeof(std::int32_t),
            [&](std::size_t begin, std::size_t end, char* out) {
                fillLists(table.pointsEnd, begin, end, out,
                          [&](std::int32_t cell, std::vector<std::int32_t>& list) {
                              const auto faces = table.faces[cell];
                              if (table.types[static_cast<std::size_t>(cell)] ==
                                  static_cast<std::uint8_t>(VtkCell::polyhedron))
                                  return cellPoints(mesh, faces, list);
                              const CellShape shape = shapeOf(mesh, faces, cell);
                              list.assign(shape.points.begin(),
                                          shape.points.begin() +
                                              static_cast<std::ptrdiff_t>(shape.pointCount));
                          });
            }};
}

Array facesArray(const PolyMesh& mesh, const CellTable& table) {
    return {attributes<std::int32_t>("faces"), static_cast<std::size_t>(table.facesEnd.back()),
            sizeof(std::int32_t), [&](std::size_t begin, std::size_t end, char* out) {
                fillLists(table.facesEnd, begin, end, out,
                          [&](std::int32_t cell, std::vector<std::int32_t>& list) {
                              appendFaceStream(mesh, table.faces[cell], cell, list);
                          });
            }};
}

// Offsets with T wide enough for the last of them; -1 where the cell has none of its own (faceoffsets).
template <class T>
Array offsetsArray(const std::string& name, const ListEnds& ends,
                   const CellTable* polyhedraOf) {
    return {attributes<T>(name), ends.size(), sizeof(T),
            [&ends, polyhedraOf](std::size_t begin, std::size_t end, char* out) {
                for (std::size_t c = begin; c < end; ++c, out += sizeof(T)) {
                    const bool none = polyhedraOf &&
                                      polyhedraOf->types[c] != static_cast<std::uint8_t>(VtkCell::polyhedron);
                    const T value = none ? T(-1) : static_cast<T>(ends[c]);
                    std::memcpy(out, &value, sizeof value);
                }
            }};
}

Array offsets(const std::string& name, const ListEnds& ends,
              const CellTable* polyhedraOf = nullptr) {
    const bool small = ends.back() <= 0x7fffffff;
    return small ? offsetsArray<std::int32_t>(name, ends, polyhedraOf)
                 : offsetsArray<std::int64_t>(name, ends, polyhedraOf);
}

std::vector<std::int32_t> wallPatches(const PolyMesh& mesh) {
    std::vector<std::int32_t> result(static_cast<std::size_t>(mesh.cells), -1);
    for (std::size_t p = 0; p < mesh.patches.size(); ++p) {
        const Patch& patch = mesh.patches[p];
        if (patch.type != "wall") continue;
        for (std::int32_t f = patch.start; f < patch.start + patch.count; ++f) {
            std::int32_t& at = result[static_cast<std::size_t>(mesh.owner[static_cast<std::size_t>(f)])];
            if (at < 0) at = static_cast<std::int32_t>(p);
        }
    }
    return result;
}

// Writes the arrays' data after one another. The tables of block sizes come before the data they describe, so
// they are left blank and filled in afterwards.
class Appender {
  public:
    Appender(OutputFile& file, const VtuWriteOptions& options, const Context& context)
        : file_(file), options_(options), context_(context), start_(file.size()) {}

    void append(const Array& array) {
        const std::string offset = fmt::format("{}\"", file_.size() - start_);
        file_.patch(array.offsetField, offset.data(), offset.size());
        options_.compress ? appendCompressed(array) : appendRaw(array);
    }

  private:
    using Compressor = std::unique_ptr<libdeflate_compressor, decltype(&libdeflate_free_compressor)>;

    static void fill(const Array& array, std::size_t block, std::string& out) {
        const std::size_t per = blockBytes / array.elementBytes;
        const std::size_t begin = block * per, end = std::min(array.elements, begin + per);
        out.resize((end - begin) * array.elementBytes);
        array.fill(begin, end, out.data());
    }

    static std::size_t blocks(const Array& array) {
        const std::size_t per = blockBytes / array.elementBytes;
        return (array.elements + per - 1) / per;
    }

    void appendRaw(const Array& array) {
        const std::uint64_t bytes = array.elements * array.elementBytes;
        file_.write(&bytes, sizeof bytes);
        pipeBlocks(
            blocks(array), [&](std::size_t i, std::string& out) { fill(array, i, out); },
            [&](std::size_t, const std::string& bytesOut) { file_.write(bytesOut); }, context_);
    }

    void appendCompressed(const Array& array) {
        const std::size_t n = blocks(array), per = blockBytes / array.elementBytes;
        const std::size_t rest = array.elements % per * array.elementBytes; // 0: the last block is full
        std::vector<std::uint64_t> table(3 + n, 0);
        table[0] = n, table[1] = per * array.elementBytes, table[2] = rest;
        const std::uint64_t at = file_.size();
        file_.write(table.data(), table.size() * sizeof(std::uint64_t));
        const auto take = [&](std::size_t i, const std::string& bytes) {
            table[3 + i] = bytes.size();
            file_.write(bytes);
        };
        pipeBlocks(
            n, [&](std::size_t i, std::string& out) { compress(array, i, out); }, take, context_);
        file_.patch(at, table.data(), table.size() * sizeof(std::uint64_t));
    }

    void compress(const Array& array, std::size_t block, std::string& out) {
        Compressor& compressor = compressors_.local();
        std::string& plain = plain_.local();
        fill(array, block, plain);
        out.resize(libdeflate_zlib_compress_bound(compressor.get(), plain.size()));
        out.resize(
            libdeflate_zlib_compress(compressor.get(), plain.data(), plain.size(), out.data(), out.size()));
    }

    OutputFile& file_;
    const VtuWriteOptions& options_;
    const Context& context_;
    std::uint64_t start_;
    tbb::enumerable_thread_specific<Compressor> compressors_{[this] {
        return Compressor(libdeflate_alloc_compressor(options_.compression), &libdeflate_free_compressor);
    }};
    tbb::enumerable_thread_specific<std::string> plain_;
};

void writeDeclaration(OutputFile& file, Array& array) {
    file.write(fmt::format("        <DataArray {} format=\"appended\" offset=\"", array.attributes));
    array.offsetField = file.size();
    // Room for the number and its closing quote; the rest stays blank.
    file.write("\"" + std::string(offsetDigits, ' ') + "/>\n");
}

void writeGroup(OutputFile& file, const char* name, std::span<Array> arrays) {
    file.write(fmt::format("      <{}>\n", name));
    for (Array& array : arrays) writeDeclaration(file, array);
    file.write(fmt::format("      </{}>\n", name));
}

// Values of some cells or points, 0 at all others. Keeps references.
template <class T>
Array sparseArray(const std::string& name, std::span<const std::int32_t> items, std::span<const T> values, std::size_t all) {
    return {attributes<T>(name), all, sizeof(T), [items, values](std::size_t begin, std::size_t end, char* out) {
                std::memset(out, 0, (end - begin) * sizeof(T));
                auto at = std::lower_bound(items.begin(), items.end(), static_cast<std::int32_t>(begin));
                for (; at != items.end() && static_cast<std::size_t>(*at) < end; ++at) {
                    const T value = values[static_cast<std::size_t>(at - items.begin())];
                    std::memcpy(out + (static_cast<std::size_t>(*at) - begin) * sizeof(T), &value, sizeof value);
                }
            }};
}

std::vector<Array> pointArrays(const PolyMesh& mesh, const std::vector<PointData>& data) {
    std::vector<Array> arrays;
    for (const PointData& d : data) {
        std::visit(
            [&](const auto& values) {
                if (values.size() != d.points.size())
                    throw Error(ErrorKind::internal, fmt::format("point data '{}' has {} values for {} points", d.name, values.size(), d.points.size()), "", "");
                arrays.push_back(sparseArray(d.name, std::span(d.points), std::span(values), mesh.points.size()));
            },
            d.values);
    }
    return arrays;
}

std::vector<Array> cellArrays(const PolyMesh& mesh, const std::vector<CellData>& data,
                              const std::vector<std::int32_t>& walls) {
    std::vector<Array> arrays;
    if (!mesh.cellLevel.empty()) arrays.push_back(plainArray<std::uint8_t>("level", mesh.cellLevel));
    if (!mesh.cellLayer.empty()) arrays.push_back(plainArray<std::uint8_t>("layer", mesh.cellLayer));
    if (!mesh.cellRegion.empty()) arrays.push_back(plainArray<std::int32_t>("region", mesh.cellRegion));
    arrays.push_back(plainArray<std::int32_t>("patch", walls));
    for (const CellData& d : data)
        arrays.push_back(d.cells && d.cells->size() == d.values.size()
                             ? sparseArray(d.name, std::span(*d.cells), std::span(d.values), static_cast<std::size_t>(mesh.cells))
                             : plainArray<float>(d.name, d.values));
    for (const Array& array : arrays)
        if (array.elements != static_cast<std::size_t>(mesh.cells))
            throw Error(ErrorKind::internal, "cell data does not have one value for each cell",
                        array.attributes, "report this");
    return arrays;
}

} // namespace

void writeVtu(const PolyMesh& mesh, const Rows& cellFaces, const std::vector<CellData>& data, const std::filesystem::path& path,
              const VtuWriteOptions& options, const Context& context, const std::vector<PointData>& values) {
    const std::vector<std::int32_t> walls = wallPatches(mesh);
    std::vector<Array> cellData = cellArrays(mesh, data, walls), pointData = pointArrays(mesh, values);
    const CellTable table = buildCellTable(mesh, cellFaces);
    context.checkCancelled();
    Array points = plainArray<double>("Points", {&mesh.points.data()->x, 3 * mesh.points.size()});
    points.attributes += " NumberOfComponents=\"3\"";
    std::vector<Array> cells;
    cells.push_back(connectivityArray(mesh, table));
    cells.push_back(offsets("offsets", table.pointsEnd));
    cells.push_back(plainArray<std::uint8_t>("types", table.types));
    if (table.polyhedra()) {
        cells.push_back(facesArray(mesh, table));
        cells.push_back(offsets("faceoffsets", table.facesEnd, &table));
    }

    OutputFile file(path);
    file.write(fmt::format("<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" "
                           "byte_order=\"LittleEndian\" header_type=\"UInt64\"{}>\n",
                           options.compress ? " compressor=\"vtkZLibDataCompressor\"" : ""));
    file.write(fmt::format("  <UnstructuredGrid>\n    <Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n",
                           mesh.points.size(), mesh.cells));
    if (!pointData.empty()) writeGroup(file, "PointData", pointData);
    writeGroup(file, "CellData", cellData);
    writeGroup(file, "Points", {&points, 1});
    writeGroup(file, "Cells", cells);
    file.write("    </Piece>\n  </UnstructuredGrid>\n  <AppendedData encoding=\"raw\">\n   _");
    Appender appender(file, options, context);
    for (const Array& array : pointData) appender.append(array);
    for (const Array& array : cellData) appender.append(array);
    appender.append(points);
    for (const Array& array : cells) appender.append(array);
    file.write("\n  </AppendedData>\n</VTKFile>\n");
    file.close();
}

} // namespace i2b
