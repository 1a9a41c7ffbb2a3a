// Names of parts as OpenFOAM takes them for patches: letters, digits, "_", ".", "-", not beginning with a
// digit.
#pragma once
#include <regex>
#include <string>
#include <string_view>
#include <vector>

namespace i2b {

// "front wheel: 2" -> "front_wheel_2", "3rd" -> "part_3rd"; "" if nothing readable is left. At most 80
// characters.
std::string toWord(std::string_view name);

// True for what programs write when they have no name: "", "ascii", "OpenSCAD_Model", "Exported from
// Blender-2.79 (sub 0)".
bool isUninformative(std::string_view name);

// File name without its folder, ".gz" and extension, as a word; "part" if nothing is left.
std::string stemOf(const std::string& path);

// Makes names unique by "_2", "_3", ...; the first of equals keeps its name, and no name met first loses it.
void makeUnique(std::vector<std::string>& names);

// A part or patch as users name it: its whole name, or a regular expression (ECMAScript) that the whole name matches.
class NamePattern {
  public:
    explicit NamePattern(const std::string& text); // throws std::regex_error
    bool matches(const std::string& name) const;

  private:
    std::string text_;
    std::regex expression_;
};

} // namespace i2b
