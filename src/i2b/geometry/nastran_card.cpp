#include "i2b/geometry/nastran_card.h"
#include <algorithm>
#include <limits>

namespace i2b {
namespace {

constexpr std::size_t nameColumns = 8, dataColumns = 72; // what follows is a mark for the next line
constexpr std::size_t mostReal = 40;                     // characters of a number

// Tabs lead to the next column that is a multiple of 8.
std::string withoutTabs(std::string_view line) {
    std::string out;
    for (const char c : line) {
        if (c != '\t') out += c;
        else out.append(8 - out.size() % 8, ' ');
    }
    return out;
}

std::string_view columns(std::string_view line, std::size_t from, std::size_t count) {
    return from < line.size() ? text::trimmed(line.substr(from, std::min(count, line.size() - from))) : std::string_view{};
}

} // namespace

bool continuesCard(std::string_view line) {
    if (line.empty()) return false;
    if (line.front() == '+' || line.front() == '*' || line.front() == ',') return true;
    if (!text::isSpace(line.front())) return false;
    const std::string_view rest = text::trimmed(line);
    return !rest.empty() && rest.front() != '$' && (line.front() == '\t' || columns(line, 0, nameColumns).empty());
}

void NastranCard::addLine(std::string_view line, std::string& tabless) {
    line = line.substr(0, line.find('$'));
    const bool isFree = line.substr(0, nameColumns + 2).find(',') != std::string_view::npos;
    if (!isFree && line.find('\t') != std::string_view::npos) line = tabless = withoutTabs(line);
    const std::string_view first = isFree ? text::trimmed(line.substr(0, line.find(','))) : columns(line, 0, nameColumns);
    const bool isLarge = first.find('*') != std::string_view::npos;
    if (count_ == 0) name_ = text::trimmed(first.substr(0, first.find('*')));
    const std::size_t fields = isLarge ? 4 : 8, width = isLarge ? 16 : 8;
    std::size_t at = isFree ? std::min(line.size(), line.find(',')) : nameColumns;
    for (std::size_t i = 0; i < fields && count_ < mostFields; ++i) {
        std::string_view field;
        if (isFree && at < line.size()) {
            const std::size_t end = std::min(line.size(), line.find(',', at + 1));
            field = text::trimmed(line.substr(at + 1, end - at - 1));
            at = end;
        } else if (!isFree) {
            field = columns(line.substr(0, std::min(line.size(), dataColumns)), at, width);
            at += width;
        }
        fields_[count_++] = field;
    }
}

void NastranCard::read(text::Cursor& c) {
    name_ = {}, count_ = 0;
    for (std::string& tabless : tabless_) {
        addLine(c.line(), tabless);
        c.skipLine(), c.skipLineEnd();
        if (count_ == mostFields || !continuesCard(c.line())) return;
    }
}

std::optional<std::int64_t> NastranCard::integer(std::size_t i) const {
    if (i >= count_ || fields_[i].empty()) return 0;
    std::string_view field = fields_[i];
    if (field.front() == '+') field.remove_prefix(1);
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
    return error == std::errc() && end == field.data() + field.size() ? std::optional(value) : std::nullopt;
}

std::optional<double> NastranCard::real(std::size_t i) const {
    if (i >= count_ || fields_[i].empty()) return 0;
    std::string_view field = fields_[i];
    if (field.front() == '+') field.remove_prefix(1);
    double value = 0;
    const char* const last = field.data() + field.size();
    const auto [end, error] = std::from_chars(field.data(), last, value);
    if (error == std::errc() && end == last) return value;
    std::array<char, mostReal> plain; // with an exponent as others write it
    std::size_t n = 0;
    if (field.size() + 2 > plain.size()) return {};
    for (std::size_t k = 0; k < field.size(); ++k) {
        const char c = text::lower(field[k]);
        const bool afterLetter = n > 0 && plain[n - 1] == 'e';
        if ((c == '+' || c == '-') && k > 0 && !afterLetter) plain[n++] = 'e';
        if (c != '+') plain[n++] = c == 'd' ? 'e' : c;
    }
    const auto [stop, fault] = std::from_chars(plain.data(), plain.data() + n, value);
    if (stop != plain.data() + n || n == 0) return {};
    if (fault == std::errc::result_out_of_range) return field.find('-', 1) != std::string_view::npos ? 0.0 : std::numeric_limits<double>::infinity();
    return fault == std::errc() ? std::optional(value) : std::nullopt;
}

} // namespace i2b
