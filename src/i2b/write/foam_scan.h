// Reads OpenFOAM's list and dictionary syntax from the bytes of a file.
#pragma once
#include "i2b/core/raw_vector.h"
#include "i2b/core/vec.h"
#include "i2b/geometry/mapped_file.h"
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace i2b {

struct FoamHeader {
    std::string type; // the entry "class"
    bool binary = false;
    int labelBytes = 4, scalarBytes = 8;
};

class FoamScanner {
  public:
    explicit FoamScanner(const MappedFile& file); // reads the header
    const FoamHeader& header() const { return header_; }

    std::string_view peek(); // the next token: one of (){}[]; or a word, or a quoted string
    std::string_view next();
    void expect(std::string_view token);
    std::int64_t integer();

    RawVector<std::int32_t> labels();               // N(...) or N{value}
    void appendLabels(RawVector<std::int32_t>& to); // the same, at the end of a list
    RawVector<std::uint32_t> offsets();             // labels, none below 0
    RawVector<Vec3> points();

    [[noreturn]] void fail(const std::string& what) const;

  private:
    std::string_view peekSome(); // fails at the end of the file
    void skipSpace();
    std::size_t pastSpace() const;      // where the next token begins, unless it is a comment
    bool endsAt(std::size_t at) const;  // does a token end before there?
    void readHeader();
    double scalar();
    std::int32_t checkedLabel(std::int64_t value) const;
    std::string_view raw(std::size_t count, std::size_t size); // the bytes between ( and )
    std::size_t count(std::size_t leastBytesEach);
    template <class Label>
    void appendTo(RawVector<Label>& to);

    const MappedFile& file_;
    std::string_view text_;
    std::size_t at_ = 0;
    FoamHeader header_;
};

} // namespace i2b
