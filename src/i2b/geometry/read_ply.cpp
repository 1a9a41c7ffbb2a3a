// PLY: points and polygons, in text or in bytes of either order. Faces that say their part, as the walls do that are written here, keep it.
#include "i2b/core/error.h"
#include "i2b/geometry/file_soup.h"
#include "i2b/geometry/ply_header.h"
#include "i2b/geometry/text_scan.h"
#include <algorithm>
#include <bit>
#include <cstring>
#include <fmt/format.h>
#include <optional>
#include <unordered_map>

namespace i2b {
namespace {

constexpr std::array<std::size_t, 8> sizes{1, 1, 2, 2, 4, 4, 4, 8}; // bytes, by PlyType
constexpr std::int64_t mostCorners = 1 << 20;                      // of a face

// The values of a file, one after the other.
class PlyValues {
  public:
    PlyValues(std::string_view bytes, PlyEncoding encoding) : c_{bytes.data(), bytes.data() + bytes.size()}, encoding_(encoding) {}
    std::size_t left() const { return static_cast<std::size_t>(c_.end - c_.at); }
    bool next(PlyType type, double& value) { return encoding_ == PlyEncoding::ascii ? nextWord(value) : nextBytes(type, value); }

  private:
    bool nextWord(double& value) {
        c_.skipBlank();
        const char* const end = c_.done() ? nullptr : text::number(c_.at, c_.end, value);
        if (end) c_.at = end;
        return end != nullptr;
    }
    bool nextBytes(PlyType type, double& value) {
        const std::size_t size = sizes[static_cast<std::size_t>(type)];
        if (left() < size) return false;
        std::array<char, 8> raw{};
        for (std::size_t i = 0; i < size; ++i) raw[i] = c_.at[encoding_ == PlyEncoding::bigEndian ? size - 1 - i : i];
        c_.at += size;
        static_assert(std::endian::native == std::endian::little);
        switch (type) {
        case PlyType::int8: value = as<std::int8_t>(raw); break;
        case PlyType::uint8: value = as<std::uint8_t>(raw); break;
        case PlyType::int16: value = as<std::int16_t>(raw); break;
        case PlyType::uint16: value = as<std::uint16_t>(raw); break;
        case PlyType::int32: value = as<std::int32_t>(raw); break;
        case PlyType::uint32: value = as<std::uint32_t>(raw); break;
        case PlyType::float32: value = as<float>(raw); break;
        case PlyType::float64: value = as<double>(raw); break;
        }
        return true;
    }
    template <class T>
    static double as(const std::array<char, 8>& raw) {
        T value;
        std::memcpy(&value, raw.data(), sizeof value);
        return static_cast<double>(value);
    }

    text::Cursor c_;
    PlyEncoding encoding_;
};

class PlyReader {
  public:
    PlyReader(const MappedFile& file, double scale) : file_(file), scale_(scale), header_(readPlyHeader(file.bytes())), values_(file.bytes().substr(header_.bytes), header_.encoding) {}
    FileSoup run();

  private:
    [[noreturn]] void refuse(std::string what) const { throw Error(ErrorKind::input, std::move(what), file_.path(), "export it again"); }
    [[noreturn]] void endsAt(const PlyElement& element, std::uint64_t i) const {
        refuse(fmt::format("the PLY file ends or has something that is no number at {} {} of {}; it may be truncated ({} bytes)", element.name, i + 1, element.count, file_.bytes().size()));
    }
    void readPoints(const PlyElement& element);
    void readFaces(const PlyElement& element);
    void passOver(const PlyElement& element);
    double value(const PlyElement& element, std::uint64_t i, PlyType type) {
        double v = 0;
        if (!values_.next(type, v)) endsAt(element, i);
        return v;
    }
    // f(property, place in a list, value)
    template <class F>
    void forValues(const PlyElement& element, std::uint64_t i, const F& f) {
        for (std::size_t k = 0; k < element.properties.size(); ++k) {
            const PlyProperty& property = element.properties[k];
            double count = 1;
            if (property.isList) count = value(element, i, property.count);
            if (!(count >= 0 && count <= mostCorners)) endsAt(element, i);
            for (int n = 0; n < static_cast<int>(count); ++n) f(k, value(element, i, property.type));
        }
    }
    void addFace(const std::vector<double>& corners, double part, std::uint64_t i);
    std::int32_t partOf(double number);

    const MappedFile& file_;
    double scale_;
    PlyHeader header_;
    PlyValues values_;
    FileSoup soup_;
    std::vector<Vec3> points_;
    std::unordered_map<std::int64_t, std::int32_t> parts_;
    std::uint64_t shortFaces_ = 0;
};

void PlyReader::readPoints(const PlyElement& element) {
    std::array<std::size_t, 3> at{~std::size_t{0}, ~std::size_t{0}, ~std::size_t{0}};
    for (std::size_t k = 0; k < element.properties.size(); ++k)
        for (std::size_t axis = 0; axis < 3; ++axis)
            if (element.properties[k].name == std::array{"x", "y", "z"}[axis] && !element.properties[k].isList) at[axis] = k;
    if (std::ranges::max(at) == ~std::size_t{0}) refuse("the points of the PLY file have no x, y and z");
    for (std::uint64_t i = 0; i < element.count; ++i) {
        Vec3 p;
        forValues(element, i, [&](std::size_t k, double v) {
            for (int axis = 0; axis < 3; ++axis)
                if (at[static_cast<std::size_t>(axis)] == k) p[axis] = v;
        });
        points_.push_back(p * scale_);
    }
}

std::int32_t PlyReader::partOf(double number) {
    std::vector<Part>& parts = soup_.surface.parts;
    const auto key = std::abs(number) < 1e15 ? static_cast<std::int64_t>(number) : 0;
    const auto [at, isNew] = parts_.try_emplace(key, static_cast<std::int32_t>(parts.size()));
    if (isNew) {
        const auto name = header_.parts.find(key);
        parts.push_back({name == header_.parts.end() ? "" : name->second, file_.path(), 0});
    }
    return at->second;
}

void PlyReader::addFace(const std::vector<double>& corners, double part, std::uint64_t i) {
    shortFaces_ += corners.size() < 3;
    const auto point = [&](std::size_t k) {
        if (!(corners[k] >= 0 && corners[k] < static_cast<double>(points_.size())))
            refuse(fmt::format("face {} names point {}, and the file has {}", i + 1, corners[k], points_.size()));
        return static_cast<std::uint32_t>(corners[k]);
    };
    for (std::size_t k = 2; k < corners.size(); ++k) {
        const std::array<std::uint32_t, 3> v{point(0), point(k - 1), point(k)};
        const TriangleKind kind = kindOf(points_[v[0]], points_[v[1]], points_[v[2]]);
        if (!isKept(kind, soup_.notes)) continue;
        const std::int32_t of = partOf(part);
        ++soup_.surface.parts[static_cast<std::size_t>(of)].triangles;
        soup_.surface.triangles.push_back(v), soup_.surface.partOf.push_back(of);
    }
}

void PlyReader::readFaces(const PlyElement& element) {
    std::optional<std::size_t> list, part;
    for (std::size_t k = 0; k < element.properties.size(); ++k) {
        const PlyProperty& property = element.properties[k];
        if (property.isList && (property.name == "vertex_indices" || property.name == "vertex_index")) list = k;
        if (!property.isList && property.name == "part") part = k;
    }
    if (!list) refuse("the faces of the PLY file have no list of points");
    std::vector<double> corners;
    for (std::uint64_t i = 0; i < element.count; ++i) {
        corners.clear();
        double number = 0;
        forValues(element, i, [&](std::size_t k, double v) {
            if (k == *list) corners.push_back(v);
            if (k == part) number = v;
        });
        addFace(corners, number, i);
    }
}

void PlyReader::passOver(const PlyElement& element) {
    for (std::uint64_t i = 0; i < element.count && !element.properties.empty(); ++i) forValues(element, i, [](std::size_t, double) {});
}

FileSoup PlyReader::run() {
    if (!header_.fault.empty()) refuse(header_.fault);
    for (const PlyElement& element : header_.elements) {
        if (element.count > values_.left()) endsAt(element, 0); // each takes a byte at least
        if (element.name == "vertex") readPoints(element);
        else if (element.name == "face") readFaces(element);
        else passOver(element);
    }
    if (points_.size() >= ~std::uint32_t{0}) refuse("the file has more points than 32 bits count");
    const auto note = [&](std::string text) { soup_.notes.messages.push_back(file_.path() + ": " + std::move(text)); };
    if (soup_.notes.notNumbers > 0) note(fmt::format("{} triangles with coordinates that are not usable numbers were left out", soup_.notes.notNumbers));
    if (shortFaces_ > 0) note(fmt::format("{} faces with less than three corners were left out", shortFaces_));
    keepUsedPoints(points_, soup_.surface);
    return std::move(soup_);
}

} // namespace

bool looksLikePly(std::string_view bytes) { return bytes.size() > 4 && bytes.starts_with("ply") && text::isLineEnd(bytes[3]); }

FileSoup readPly(const MappedFile& file, double scale) { return PlyReader(file, scale).run(); }

} // namespace i2b
