#include "i2b/geometry/text_scan.h"
#include "i2b/core/parallel.h"
#include <algorithm>
#include <limits>

namespace i2b::text {

bool equalsNoCase(std::string_view a, std::string_view lowerCase) {
    return std::equal(a.begin(), a.end(), lowerCase.begin(), lowerCase.end(),
                      [](char x, char y) { return lower(x) == y; });
}

std::string_view trimmed(std::string_view s) {
    while (!s.empty() && isBlank(s.front())) s.remove_prefix(1);
    while (!s.empty() && isBlank(s.back())) s.remove_suffix(1);
    return s;
}

const char* oddNumber(const char* first, const char* last, double& value) {
    const char* end = first;
    while (end != last && !isBlank(*end) && *end != '\\') ++end;
    std::string token(first, end);
    if (token.empty()) return nullptr;
    if (token.find('#') != std::string::npos && token.find_first_of("0123456789") != std::string::npos) {
        value = std::numeric_limits<double>::quiet_NaN(); // 1.#QNAN, -1.#IND, 1.#INF of an old C library
        return end;
    }
    for (char& c : token) // an exponent as Fortran writes it
        if (c == 'd' || c == 'D') c = 'e';
    const auto [stop, error] = std::from_chars(token.data(), token.data() + token.size(), value);
    if (stop != token.data() + token.size()) return nullptr;
    if (error == std::errc::result_out_of_range) {
        const bool tiny = token.find("e-") != std::string::npos || token.find("E-") != std::string::npos;
        value = tiny ? 0 : std::numeric_limits<double>::infinity();
        return end;
    }
    return error == std::errc() ? end : nullptr;
}

std::uint64_t lineOf(std::string_view text, std::size_t at) {
    at = std::min(at, text.size());
    return orderedReduce(
        at, std::uint64_t{1},
        [&](std::size_t begin, std::size_t end) {
            std::uint64_t lines = 0;
            for (std::size_t i = begin; i != end; ++i)
                lines +=
                    text[i] == '\n' || (text[i] == '\r' && (i + 1 == text.size() || text[i + 1] != '\n'));
            return lines;
        },
        [](std::uint64_t a, std::uint64_t b) { return a + b; }, std::size_t{1} << 20);
}

} // namespace i2b::text
