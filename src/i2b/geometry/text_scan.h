// Scanning of text geometry: tokens, numbers, and where a large text may be cut so that its pieces are read
// at once. Nothing here throws; lines end at \n, \r\n or \r.
#pragma once
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace i2b::text {

constexpr bool isSpace(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }
constexpr bool isLineEnd(char c) { return c == '\n' || c == '\r'; }
constexpr bool isBlank(char c) { return isSpace(c) || isLineEnd(c); }
constexpr char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; }

bool equalsNoCase(std::string_view a, std::string_view lowerCase);
std::string_view trimmed(std::string_view s);

// What from_chars does not take at once: 1.#QNAN, 1.0D+3, numbers out of range. Null if the token is no
// number.
const char* oddNumber(const char* first, const char* last, double& value);

// Reads a number at first and returns its end, or null if there is none that ends at a blank (or line
// continuation).
inline const char* number(const char* first, const char* last, double& value) {
    if (first != last && *first == '+') ++first;
    const auto [end, error] = std::from_chars(first, last, value);
    if (error == std::errc() && (end == last || isBlank(*end) || *end == '\\')) return end;
    return oddNumber(first, last, value);
}

// A place in a text. The functions below move it and stop at its end.
struct Cursor {
    const char* at;
    const char* end;

    bool done() const { return at == end; }
    void skipSpace() {
        while (at != end && isSpace(*at)) ++at;
    }
    void skipBlank() {
        while (at != end && isBlank(*at)) ++at;
    }
    void skipLine() {
        while (at != end && !isLineEnd(*at)) ++at;
    }
    void skipLineEnd() { // one
        if (at != end && *at == '\r') ++at;
        if (at != end && *at == '\n') ++at;
    }
    std::string_view line() const { // what is left of it, as it is
        Cursor ahead = *this;
        ahead.skipLine();
        return {at, static_cast<std::size_t>(ahead.at - at)};
    }
    std::string_view token() { // after blanks; empty at the end
        skipBlank();
        const char* const begin = at;
        while (at != end && !isBlank(*at)) ++at;
        return {begin, static_cast<std::size_t>(at - begin)};
    }
    std::string_view restOfLine() {
        const char* const begin = at;
        skipLine();
        return trimmed({begin, static_cast<std::size_t>(at - begin)});
    }
};

// The number of the line that holds byte at, from 1.
std::uint64_t lineOf(std::string_view text, std::size_t at);

// Offsets of pieces of about `size` bytes, the first 0; every other one is the begin of a line that
// canStart(rest) accepts. Depends on the text alone, never on the number of threads.
template <class CanStart>
std::vector<std::size_t> pieces(std::string_view text, std::size_t size, const CanStart& canStart) {
    std::vector<std::size_t> starts{0};
    for (std::size_t at = size; at < text.size();) {
        while (at < text.size() && !(isLineEnd(text[at - 1]) && canStart(text, at))) ++at;
        if (at == text.size()) break;
        starts.push_back(at);
        at += size;
    }
    return starts;
}

} // namespace i2b::text
