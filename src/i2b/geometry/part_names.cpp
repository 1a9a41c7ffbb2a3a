#include "i2b/geometry/part_names.h"
#include "i2b/geometry/text_scan.h"
#include <algorithm>
#include <array>
#include <filesystem>
#include <unordered_map>
#include <unordered_set>

namespace i2b {
namespace {

constexpr std::size_t longest = 80;

// Not isalnum: it follows the locale.
bool isDigit(char c) { return c >= '0' && c <= '9'; }
bool isWordCharacter(char c) {
    return isDigit(c) || (text::lower(c) >= 'a' && text::lower(c) <= 'z') || c == '_' || c == '.' || c == '-';
}

std::string lowered(std::string_view s) {
    std::string result(s);
    std::transform(result.begin(), result.end(), result.begin(), text::lower);
    return result;
}

} // namespace

std::string toWord(std::string_view name) {
    std::string word;
    for (const char c : name) {
        const char take = isWordCharacter(c) ? c : '_';
        if (take == '_' && (word.empty() || word.back() == '_')) continue;
        if (word.size() < longest) word.push_back(take);
    }
    while (!word.empty() && (word.back() == '_' || word.back() == '.')) word.pop_back();
    // A leading dot or dash makes a hidden file or an option of the name; a leading digit is no word.
    const std::size_t begin = std::min(word.find_first_not_of("._-"), word.size());
    word.erase(0, begin);
    if (!word.empty() && isDigit(word.front())) word = "part_" + word;
    return word;
}

bool isUninformative(std::string_view name) {
    static constexpr std::array names{
        "ascii",   "ascii_stl", "stl",     "stl_ascii",      "solid",     "exported", "export",
        "default", "object",    "mesh",    "unnamed",        "noname",    "unknown",  "untitled",
        "null",    "none",      "off",     "openscad_model", "autocad",   "part",     "foo",
        "model",   "facet",     "surface", "stl_file",       "solid_name"};
    static constexpr std::array beginnings{
        "exported_from", "stl_exported",          "stl_generated", "created_by",  "generated_by",
        "mesh_exported", "visualization_toolkit", "vcg",           "exported_by", "output_by",
        "binary_stl"};
    const std::string word = lowered(toWord(name));
    if (word.empty()) return true;
    return std::any_of(names.begin(), names.end(), [&](const char* n) { return word == n; }) ||
           std::any_of(beginnings.begin(), beginnings.end(),
                       [&](const char* b) { return word.starts_with(b); });
}

std::string stemOf(const std::string& path) {
    std::filesystem::path file = std::filesystem::path(path).filename();
    if (text::equalsNoCase(file.extension().string(), ".gz")) file = file.stem();
    const std::string word = toWord(file.stem().string());
    return word.empty() ? "part" : word;
}

void makeUnique(std::vector<std::string>& names) {
    std::unordered_set<std::string> taken(names.begin(), names.end());
    std::unordered_map<std::string, std::size_t> seen;
    for (std::string& name : names) {
        std::size_t& count = seen[name];
        if (++count == 1) continue;
        std::string unique = name + "_" + std::to_string(count);
        while (taken.contains(unique)) unique = name + "_" + std::to_string(++count);
        taken.insert(unique);
        name = std::move(unique);
    }
}

NamePattern::NamePattern(const std::string& text) : text_(text), expression_(text, std::regex::ECMAScript) {}

bool NamePattern::matches(const std::string& name) const {
    return name == text_ || std::regex_match(name, expression_);
}

} // namespace i2b
