// Nastran bulk data: shells by their corners, a part for each property. Points are named by numbers of the file's own in any order, so pieces
// are read first, then their points are sorted by number, and only then can corners be resolved.
#include "i2b/core/error.h"
#include "i2b/core/give_up.h"
#include "i2b/core/parallel.h"
#include "i2b/geometry/file_soup.h"
#include "i2b/geometry/nastran_piece.h"
#include "i2b/geometry/text_scan.h"
#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <map>
#include <tbb/parallel_sort.h>
#include <unordered_map>

namespace i2b {
namespace {

using Piece = NastranPiece;
constexpr std::size_t pieceBytes = std::size_t{1} << 20;
constexpr std::size_t headBytes = std::size_t{1} << 16; // in which a deck shows that it is one
constexpr std::array<std::string_view, 8> shellNames{"ctria3", "ctria6", "ctriar", "cquad4", "cquad8", "cquadr", "cquad", "grid"};

bool isShellCard(std::string_view line) {
    return std::ranges::any_of(shellNames, [&](std::string_view name) {
        if (line.size() <= name.size() || !text::equalsNoCase(line.substr(0, name.size()), name)) return false;
        const char next = line[name.size()];
        return text::isSpace(next) || next == '*' || next == ',';
    });
}

// Names stand in comments before cards of other kinds; those are never cut off.
bool canStart(std::string_view bytes, std::size_t at) { return isShellCard(text::Cursor{bytes.data() + at, bytes.data() + bytes.size()}.line()); }

struct Deck {
    const MappedFile& file;
    std::vector<Piece> pieces;
    std::vector<std::int32_t> ids; // ascending
    std::vector<Vec3> points;      // the same order, m

    [[noreturn]] void refuse(std::string what) const { throw Error(ErrorKind::input, std::move(what), file.path(), "export it again"); }
    std::uint32_t pointOf(std::int32_t id) const { // points.size(): there is none
        const auto at = std::ranges::lower_bound(ids, id);
        return static_cast<std::uint32_t>(at == ids.end() || *at != id ? ids.size() : static_cast<std::size_t>(at - ids.begin()));
    }
};

void readPieces(Deck& deck, double scale) {
    const std::string_view bytes = deck.file.bytes();
    deck.pieces = readInPieces(deck.file, pieceBytes, canStart, [&](std::size_t begin, std::size_t end) { return readNastranPiece(bytes, begin, end, scale); });
    for (std::size_t i = 0; i < deck.pieces.size(); ++i) {
        const Piece& piece = deck.pieces[i];
        if (!piece.fault.empty()) refuseAt(deck.file, piece.fault, piece.faultAt);
        if (piece.ends) deck.pieces.resize(i + 1);
    }
}

void sortPoints(Deck& deck) {
    std::vector<std::size_t> first;
    for (const Piece& piece : deck.pieces) first.push_back(piece.grids.size());
    std::vector<Piece::Grid> grids(exclusiveScan(first));
    if (grids.size() >= ~std::uint32_t{0}) deck.refuse("the file has more points than 32 bits count");
    parallelFor(
        deck.pieces.size(),
        [&](std::size_t i) {
            const std::vector<Piece::Grid> own = std::move(deck.pieces[i].grids);
            std::copy(own.begin(), own.end(), grids.begin() + static_cast<std::ptrdiff_t>(first[i]));
        },
        1);
    const auto key = [](const Piece::Grid& g) { return std::tuple(g.id, g.place.x, g.place.y, g.place.z); };
    const auto before = [&](const Piece::Grid& a, const Piece::Grid& b) { return key(a) < key(b); };
    if (!std::is_sorted(grids.begin(), grids.end(), before)) tbb::parallel_sort(grids.begin(), grids.end(), before);
    deck.ids.reserve(grids.size()), deck.points.reserve(grids.size());
    for (const Piece::Grid& g : grids) {
        if (!deck.ids.empty() && deck.ids.back() == g.id) {
            if (!(deck.points.back() == g.place)) deck.refuse(fmt::format("GRID {} is there twice, at different places", g.id));
            continue;
        }
        deck.ids.push_back(g.id), deck.points.push_back(g.place);
    }
}

// The triangles of a piece, their properties, and what was left out.
struct Taken {
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::vector<std::int32_t> property; // per triangle
    std::uint64_t notNumbers = 0, coincident = 0, zeroArea = 0;
    std::int32_t missing = 0; // a GRID that an element names and the file lacks; 0: none
};

Taken resolve(const Deck& deck, const Piece& piece) {
    Taken taken;
    const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::int32_t property) {
        const TriangleKind kind = kindOf(deck.points[a], deck.points[b], deck.points[c]);
        if (!isKept(kind, taken)) return;
        taken.triangles.push_back({a, b, c}), taken.property.push_back(property);
    };
    for (const Piece::Element& element : piece.elements) {
        const std::size_t corners = element.grids[3] == 0 ? 3 : 4;
        std::array<std::uint32_t, 4> v{};
        for (std::size_t k = 0; k < corners; ++k) {
            v[k] = deck.pointOf(element.grids[k]);
            if (v[k] == deck.points.size()) {
                taken.missing = element.grids[k];
                return taken;
            }
        }
        if (corners == 4 && (v[2] == v[3] || v[3] == v[0])) { // a triangle written as a quadrangle
            add(v[0], v[1], v[2], element.property);
        } else if (corners == 3 || v[0] == v[1] || v[1] == v[2]) {
            add(v[0], corners == 4 && v[0] == v[1] ? v[2] : v[1], v[corners - 1], element.property);
        } else { // cut along the shorter diagonal
            const bool second = norm2(deck.points[v[1]] - deck.points[v[3]]) < norm2(deck.points[v[0]] - deck.points[v[2]]);
            const std::size_t from = second ? 1 : 0;
            add(v[from], v[from + 1], v[from + 2], element.property);
            add(v[from], v[from + 2], v[(from + 3) % 4], element.property);
        }
    }
    return taken;
}

void addNotes(const Deck& deck, FileSoup& soup) {
    std::uint64_t others = 0, includes = 0;
    for (const Piece& piece : deck.pieces) others += piece.otherElements, includes += piece.includes;
    const auto note = [&](std::string text) { soup.notes.messages.push_back(deck.file.path() + ": " + std::move(text)); };
    if (soup.notes.notNumbers > 0) note(fmt::format("{} triangles with coordinates that are not usable numbers were left out", soup.notes.notNumbers));
    if (others > 0) note(fmt::format("{} solid, bar and other elements were left out: shells are the geometry", others));
    if (includes > 0) note(fmt::format("{} INCLUDE statements were not followed: name their files too", includes));
}

// Parts in the order of their first triangles; one alone without a name takes the file's.
void nameParts(const Deck& deck, const std::vector<std::int32_t>& properties, std::vector<Part>& parts) {
    std::map<std::int32_t, std::pair<int, std::string>> names;
    for (const Piece& piece : deck.pieces)
        for (const Piece::Name& n : piece.names)
            if (auto& best = names[n.property]; n.rank > best.first) best = {n.rank, n.name};
    for (std::size_t p = 0; p < parts.size(); ++p) {
        const auto at = names.find(properties[p]);
        if (at != names.end()) parts[p].name = at->second.second;
        else if (parts.size() > 1) parts[p].name = fmt::format("property_{}", properties[p]);
    }
}

void fill(const Deck& deck, std::vector<Taken>& taken, FileSoup& soup) {
    Surface& s = soup.surface;
    std::vector<std::size_t> first;
    std::unordered_map<std::int32_t, std::int32_t> partOf;
    std::vector<std::int32_t> properties;
    for (const Taken& one : taken) {
        first.push_back(one.triangles.size());
        soup.notes.notNumbers += one.notNumbers, soup.notes.coincident += one.coincident, soup.notes.zeroArea += one.zeroArea;
        std::int32_t last = -1, part = -1;
        for (const std::int32_t property : one.property) {
            if (property != last) {
                const auto [at, isNew] = partOf.try_emplace(property, static_cast<std::int32_t>(s.parts.size()));
                if (isNew) s.parts.push_back({"", deck.file.path(), 0}), properties.push_back(property);
                last = property, part = at->second;
            }
            ++s.parts[static_cast<std::size_t>(part)].triangles;
        }
    }
    s.triangles.resize(exclusiveScan(first));
    s.partOf.resize(s.triangles.size());
    parallelFor(
        taken.size(),
        [&](std::size_t i) {
            const Taken one = std::move(taken[i]);
            for (std::size_t t = 0; t < one.triangles.size(); ++t) s.triangles[first[i] + t] = one.triangles[t], s.partOf[first[i] + t] = partOf.at(one.property[t]);
        },
        1);
    nameParts(deck, properties, s.parts);
}

} // namespace

bool looksLikeNastran(std::string_view bytes) {
    if (bytes.starts_with("\xEF\xBB\xBF")) bytes.remove_prefix(3);
    bytes = bytes.substr(0, headBytes);
    if (bytes.find('\0') != std::string_view::npos) return false;
    text::Cursor c{bytes.data(), bytes.data() + bytes.size()};
    for (; !c.done(); c.skipLine(), c.skipBlank()) {
        const std::string_view line = c.line();
        if (isShellCard(line) || (line.size() >= 10 && text::equalsNoCase(line.substr(0, 10), "begin bulk"))) return true;
    }
    return false;
}

FileSoup readNastran(const MappedFile& file, double scale) {
    FileSoup soup;
    Deck deck{file, {}, {}, {}};
    readPieces(deck, scale);
    sortPoints(deck);
    std::vector<Taken> taken(deck.pieces.size());
    parallelFor(
        taken.size(),
        [&](std::size_t i) {
            taken[i] = resolve(deck, deck.pieces[i]);
            giveUp(deck.pieces[i].elements);
        },
        1);
    for (const Taken& one : taken)
        if (one.missing != 0)
            deck.refuse(fmt::format("an element names GRID {}, which is not among the {} in the file; it may be truncated, or INCLUDE another", one.missing, deck.points.size()));
    fill(deck, taken, soup);
    addNotes(deck, soup);
    keepUsedPoints(deck.points, soup.surface);
    return soup;
}

} // namespace i2b
