#include "i2b/write/foam_scan.h"
#include "i2b/core/error.h"
#include <algorithm>
#include <charconv>
#include <cstring>
#include <fmt/format.h>
#include <iterator>
#include <limits>

namespace i2b {
namespace {

bool isSpace(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }
bool isPunctuation(char c) { return c == '(' || c == ')' || c == '{' || c == '}' || c == ';'; }

template <class T>
T load(const char* from) {
    T value;
    std::memcpy(&value, from, sizeof value);
    return value;
}

// Values that lie one after another in the bytes of a file, wherever they start there: what is copied from it need not be
// set to zero first.
template <class T>
class Packed {
  public:
    using iterator_category = std::random_access_iterator_tag;
    using value_type = T;
    using difference_type = std::ptrdiff_t;
    using pointer = const T*;
    using reference = T;

    explicit Packed(const char* at) : at_(at) {}
    T operator*() const { return load<T>(at_); }
    Packed& operator++() { return at_ += sizeof(T), *this; }
    Packed& operator--() { return at_ -= sizeof(T), *this; }
    Packed operator+(difference_type n) const { return Packed(at_ + n * difference_type(sizeof(T))); }
    Packed& operator+=(difference_type n) { return *this = *this + n; }
    difference_type operator-(const Packed& o) const { return (at_ - o.at_) / difference_type(sizeof(T)); }
    bool operator==(const Packed&) const = default;

  private:
    const char* at_;
};

template <class T, class A>
void append(std::vector<T, A>& to, std::string_view bytes) {
    to.insert(to.end(), Packed<T>(bytes.data()), Packed<T>(bytes.data() + bytes.size()));
}

int sizeAfter(std::string_view arch, std::string_view key, int otherwise) {
    const std::size_t at = arch.find(key);
    if (at == std::string_view::npos) return otherwise;
    return arch.substr(at + key.size(), 2) == "64" ? 8 : 4;
}

} // namespace

FoamScanner::FoamScanner(const MappedFile& file) : file_(file), text_(file.bytes()) { readHeader(); }

void FoamScanner::fail(const std::string& what) const {
    const auto lines = std::count(
        text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(std::min(at_, text_.size())), '\n');
    const std::string where = header_.binary ? fmt::format("{}, byte {}", file_.path(), at_)
                                             : fmt::format("{}, line {}", file_.path(), lines + 1);
    throw Error(ErrorKind::input, what, where, "write the mesh again, or convert it with foamFormatConvert");
}

void FoamScanner::skipSpace() {
    while (at_ < text_.size()) {
        if (isSpace(text_[at_])) {
            ++at_;
        } else if (text_.substr(at_, 2) == "//") {
            at_ = std::min(text_.find('\n', at_), text_.size());
        } else if (text_.substr(at_, 2) == "/*") {
            const std::size_t end = text_.find("*/", at_ + 2);
            if (end == std::string_view::npos) fail("a comment has no end");
            at_ = end + 2;
        } else {
            return;
        }
    }
}

std::string_view FoamScanner::peek() {
    const std::size_t before = at_;
    skipSpace();
    const std::size_t begin = at_;
    at_ = before;
    if (begin == text_.size()) return {};
    std::size_t end = begin + 1;
    if (text_[begin] == '"') {
        while (end < text_.size() && text_[end] != '"') ++end;
        return text_.substr(begin, std::min(end + 1, text_.size()) - begin);
    }
    if (!isPunctuation(text_[begin]))
        while (end < text_.size() && !isSpace(text_[end]) && !isPunctuation(text_[end]) && text_[end] != '"')
            ++end;
    return text_.substr(begin, end - begin);
}

std::string_view FoamScanner::next() {
    const std::string_view token = peekSome();
    at_ = static_cast<std::size_t>(token.data() - text_.data()) + token.size();
    return token;
}

std::string_view FoamScanner::peekSome() {
    const std::string_view token = peek();
    if (token.empty()) at_ = text_.size(), fail("the file ends too early");
    return token;
}

void FoamScanner::expect(std::string_view token) {
    const std::size_t begin = pastSpace();
    if (token.size() == 1 && begin < text_.size() && text_[begin] == token[0] && isPunctuation(token[0])) {
        at_ = begin + 1;
        return;
    }
    const std::string_view found = peekSome();
    if (found != token) fail(fmt::format("'{}' expected, but found '{}'", token, found.substr(0, 20)));
    next();
}

void FoamScanner::readHeader() {
    expect("FoamFile");
    expect("{");
    while (peek() != "}") {
        const std::string_view key = next();
        std::string_view value;
        while (peek() != ";") value = next();
        expect(";");
        if (key == "format") header_.binary = value == "binary";
        if (key == "class") header_.type = std::string(value);
        if (key == "arch") {
            header_.labelBytes = sizeAfter(value, "label=", 4);
            header_.scalarBytes = sizeAfter(value, "scalar=", 8);
        }
    }
    expect("}");
}

// Lists of text are nearly all numbers between blanks and brackets: these are read in place. Everything else, comments and
// faults among it, is left to the slow way.
std::size_t FoamScanner::pastSpace() const {
    std::size_t at = at_;
    while (at < text_.size() && isSpace(text_[at])) ++at;
    return at;
}

bool FoamScanner::endsAt(std::size_t at) const { return at < text_.size() && (isSpace(text_[at]) || isPunctuation(text_[at])); }

std::int64_t FoamScanner::integer() {
    constexpr std::size_t plainDigits = 12;
    const std::size_t begin = pastSpace();
    std::size_t at = begin;
    std::int64_t plain = 0;
    for (; at < text_.size() && text_[at] >= '0' && text_[at] <= '9' && at - begin < plainDigits; ++at) plain = plain * 10 + (text_[at] - '0');
    if (at > begin && endsAt(at)) {
        at_ = at;
        return plain;
    }
    const std::string_view token = peekSome();
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(token.data(), token.data() + token.size(), value);
    if (error != std::errc() || end != token.data() + token.size())
        fail(fmt::format("a whole number expected, but found '{}'", token.substr(0, 20)));
    next();
    return value;
}

double FoamScanner::scalar() {
    double plain = 0;
    const char* const begin = text_.data() + pastSpace();
    const auto [stop, fault] = std::from_chars(begin, text_.data() + text_.size(), plain);
    if (fault == std::errc() && endsAt(static_cast<std::size_t>(stop - text_.data()))) {
        at_ = static_cast<std::size_t>(stop - text_.data());
        return plain;
    }
    const std::string_view token = peekSome();
    double value = 0;
    const auto [end, error] = std::from_chars(token.data(), token.data() + token.size(), value);
    // from_chars reports numbers too small to hold as out of range; they are as good as zero.
    if ((error != std::errc() && error != std::errc::result_out_of_range) ||
        end != token.data() + token.size())
        fail(fmt::format("a number expected, but found '{}'", token.substr(0, 20)));
    next();
    return value;
}

std::int32_t FoamScanner::checkedLabel(std::int64_t value) const {
    if (value < -1 || value > std::numeric_limits<std::int32_t>::max())
        fail(fmt::format("the label {} is out of range", value));
    return static_cast<std::int32_t>(value);
}

std::size_t FoamScanner::count(std::size_t leastBytesEach) {
    const std::int64_t n = integer();
    // A damaged size must not make us reserve what the file cannot hold.
    if (n < 0 || n > std::numeric_limits<std::int32_t>::max() ||
        (peek() != "{" && static_cast<std::uint64_t>(n) * leastBytesEach > text_.size() - at_))
        fail(fmt::format("a list of {} entries cannot be in this file", n));
    return static_cast<std::size_t>(n);
}

std::string_view FoamScanner::raw(std::size_t n, std::size_t size) {
    if (n == 0) { // written as 0 or 0()
        if (peek() == "(") next(), expect(")");
        return {};
    }
    expect("(");
    if (n * size > text_.size() - at_) fail("the file ends within a list");
    const std::string_view bytes = text_.substr(at_, n * size);
    at_ += n * size;
    expect(")");
    return bytes;
}

template <class Label>
void FoamScanner::appendTo(RawVector<Label>& to) {
    const std::size_t n = count(header_.binary ? std::size_t(header_.labelBytes) : 2);
    const std::size_t start = to.size();
    if (peek() == "{") {
        next();
        if (header_.binary) fail("a list of equal labels in binary is not supported");
        to.resize(start + n, static_cast<Label>(checkedLabel(integer())));
        expect("}");
    } else if (header_.binary) {
        const auto size = static_cast<std::size_t>(header_.labelBytes);
        const std::string_view bytes = raw(n, size);
        if (size == 4) return append(to, bytes);
        to.resize(start + n);
        for (std::size_t i = 0; i < n; ++i)
            to[start + i] = static_cast<Label>(checkedLabel(load<std::int64_t>(bytes.data() + i * 8)));
    } else {
        if (n == 0 && peek() != "(") return;
        expect("(");
        to.resize(start + n);
        for (std::size_t i = 0; i < n; ++i) to[start + i] = static_cast<Label>(checkedLabel(integer()));
        expect(")");
    }
}

void FoamScanner::appendLabels(RawVector<std::int32_t>& to) { appendTo(to); }

// Labels below 0 turn out far too large, and the caller finds them out of order.
RawVector<std::uint32_t> FoamScanner::offsets() {
    RawVector<std::uint32_t> result;
    appendTo(result);
    return result;
}

RawVector<std::int32_t> FoamScanner::labels() {
    RawVector<std::int32_t> result;
    appendLabels(result);
    return result;
}

RawVector<Vec3> FoamScanner::points() {
    const auto size = static_cast<std::size_t>(header_.scalarBytes);
    const std::size_t n = count(header_.binary ? 3 * size : 7);
    RawVector<Vec3> result;
    if (header_.binary) {
        const std::string_view bytes = raw(n, 3 * size);
        static_assert(sizeof(Vec3) == 3 * sizeof(double));
        if (size == 8) {
            append(result, bytes);
        } else {
            result.resize(n);
            for (std::size_t i = 0; i < n; ++i)
                for (int k = 0; k < 3; ++k)
                    result[i][k] = load<float>(bytes.data() + (3 * i + static_cast<std::size_t>(k)) * 4);
        }
        return result;
    }
    if (n == 0 && peek() != "(") return result;
    expect("(");
    result.resize(n);
    for (Vec3& p : result) {
        expect("(");
        p.x = scalar(), p.y = scalar(), p.z = scalar();
        expect(")");
    }
    expect(")");
    return result;
}

} // namespace i2b
