// Cards of a Nastran bulk data deck (MSC Nastran Quick Reference Guide, "Format of Bulk Data Entries"): fields of 8 columns, of 16 where
// the name ends in "*", or between commas; lines go on where the next begins with a blank field, "+", "*" or a comma. Private to the
// Nastran reader.
#pragma once
#include "i2b/geometry/text_scan.h"
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace i2b {

class NastranCard {
  public:
    static constexpr std::size_t mostFields = 16; // read of a card; what follows is passed over

    // The card that begins at c, which is moved to the line after it; views into the text, or into this card where it has tabs.
    void read(text::Cursor& c);
    std::string_view name() const { return name_; } // without "*"; in the file's own case
    bool is(std::string_view lowerCase) const { return text::equalsNoCase(name_, lowerCase); }
    // Field i, from 0 after the name. Blank ones: 0. None where it is something else.
    std::optional<std::int64_t> integer(std::size_t i) const;
    std::optional<double> real(std::size_t i) const; // also 1.5-3 for 1.5e-3

  private:
    void addLine(std::string_view line, std::string& tabless);

    std::string_view name_;
    std::array<std::string_view, mostFields> fields_;
    std::size_t count_ = 0;
    std::array<std::string, 4> tabless_; // lines that had tabs
};

// Does a line go on with the card before it?
bool continuesCard(std::string_view line);

} // namespace i2b
