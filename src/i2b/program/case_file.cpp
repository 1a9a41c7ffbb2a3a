#include "i2b/program/case_file.h"
#include "i2b/core/error.h"
#include "i2b/program/entries.h"
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <iterator>
#include <sstream>
#include <toml++/toml.h>

namespace i2b {
namespace {

// One key's value on its way into its field; knows how to complain about it.
struct Value {
    const toml::node& node;
    std::string_view key;
    const std::string& path;

    [[noreturn]] void refuse(const toml::node& at, const std::string& what, const std::string& remedy) const {
        throw Error(ErrorKind::usage, what, fmt::format("{}:{}, key {}", path, at.source().begin.line, key),
                    remedy);
    }
    [[noreturn]] void wrongType(const toml::node& at, const std::string& expected) const {
        std::ostringstream type;
        type << at.type();
        refuse(at, fmt::format("{} holds a value of type {}", key, type.str()), "give " + expected);
    }
    double number(const toml::node& at) const {
        if (!at.is_number()) wrongType(at, "a number");
        return *at.value<double>();
    }
    std::string text(const toml::node& at) const {
        if (!at.is_string()) wrongType(at, "a text in quotes");
        return *at.value<std::string>();
    }
    template <std::size_t N>
    std::array<double, N> numbers(const toml::node& at) const {
        const toml::array* const list = at.as_array();
        if (!list || list->size() != N) wrongType(at, fmt::format("a list of {} numbers", N));
        std::array<double, N> values{};
        for (std::size_t i = 0; i < N; ++i) values[i] = number((*list)[i]);
        return values;
    }
    Vec3 point(const toml::node& at) const {
        const auto v = numbers<3>(at);
        return {v[0], v[1], v[2]};
    }
    // One number for all axes, or one for each.
    Vec3 size(const toml::node& at) const { return at.is_array() ? point(at) : sameSize(number(at)); }
    Box box(const toml::node& at) const {
        const auto v = numbers<6>(at);
        return {{v[0], v[1], v[2]}, {v[3], v[4], v[5]}};
    }
    const toml::array& list() const {
        if (!node.is_array()) wrongType(node, "a list");
        return *node.as_array();
    }
    // The entries of a table, all of which must be there but optional ones, and no others. Null: left out.
    std::vector<const toml::node*> entries(const toml::node& at, const std::vector<std::string_view>& names,
                                           const std::vector<bool>& optional = {}) const {
        const toml::table* const table = at.as_table();
        const std::string expected = fmt::format("{{ {} = ... }}", fmt::join(names, " = ..., "));
        if (!table) wrongType(at, expected);
        std::vector<const toml::node*> found;
        for (const std::string_view name : names) found.push_back(table->get(name));
        for (const auto& [name, entry] : *table)
            if (std::ranges::find(names, name.str()) == names.end())
                refuse(entry, fmt::format("unknown entry '{}'", name.str()), "write " + expected);
        for (std::size_t i = 0; i < found.size(); ++i)
            if (!found[i] && (i >= optional.size() || !optional[i])) refuse(at, "an entry is missing", "write " + expected);
        return found;
    }
};

void read(const Value& v, double& field) { field = v.number(v.node); }
void read(const Value& v, int& field) {
    const auto value = v.node.is_integer() ? v.node.value<int>() : std::nullopt;
    if (!value) v.wrongType(v.node, "a whole number");
    field = *value;
}
void read(const Value& v, bool& field) {
    if (!v.node.is_boolean()) v.wrongType(v.node, "true or false");
    field = *v.node.value<bool>();
}
void read(const Value& v, std::string& field) { field = v.text(v.node); }
void read(const Value& v, LayerUnit& field) {
    const auto unit = layerUnitNamed(v.text(v.node));
    if (!unit) v.refuse(v.node, fmt::format("'{}' is neither m nor cell", v.text(v.node)), "write \"m\" or \"cell\"");
    field = *unit;
}
void read(const Value& v, std::optional<Box>& field) { field = v.box(v.node); }
void read(const Value& v, std::vector<std::string>& field) {
    field.clear();
    if (v.node.is_string()) return field.push_back(v.text(v.node));
    for (const toml::node& item : v.list()) field.push_back(v.text(item));
}
void readEntry(const Value& v, const toml::node& at, std::string& entry, bool) { entry = v.text(at); }
void readEntry(const Value& v, const toml::node& at, double& entry, bool) { entry = v.number(at); }
void readEntry(const Value& v, const toml::node& at, int& entry, bool) { // a count, of which none is 0
    const auto value = at.is_integer() ? at.value<int>() : std::nullopt;
    const bool none = at.is_string() && v.text(at) == "none";
    if (!value && !none) v.wrongType(at, "a whole number, or \"none\"");
    entry = value.value_or(0);
}
void readEntry(const Value& v, const toml::node& at, Box& entry, bool) { entry = v.box(at); }
void readEntry(const Value& v, const toml::node& at, BoxEdges& entry, bool) {
    const auto edges = boxEdgesNamed(v.text(at));
    if (!edges) v.refuse(at, fmt::format("'{}' is neither all nor none", v.text(at)), "write \"all\" or \"none\"");
    entry = *edges;
}
void readEntry(const Value& v, const toml::node& at, Vec3& entry, bool size) {
    entry = size ? v.size(at) : v.point(at);
}
template <class T>
    requires HasEntries<std::vector<T>>::value
void read(const Value& v, std::vector<T>& field) {
    field.clear();
    for (const toml::node& item : v.list()) {
        T& target = field.emplace_back();
        std::apply(
            [&](const auto&... entry) {
                const auto nodes = v.entries(item, {entry.name...}, {entry.optional...});
                auto next = nodes.begin();
                const auto take = [&](const auto& e) {
                    if (const toml::node* const node = *next++) readEntry(v, *node, target.*(e.member), e.size);
                };
                (take(entry), ...);
            },
            entriesOf(target));
    }
}
void read(const Value& v, std::vector<Seed>& field) {
    field.clear();
    const toml::array& list = v.list();
    if (!list.empty() && list[0].is_number()) return field.push_back({"", v.point(list)});
    for (const toml::node& item : list) {
        if (item.is_array()) {
            field.push_back({"", v.point(item)});
            continue;
        }
        const auto entries = v.entries(item, {"name", "place"});
        field.push_back({v.text(*entries[0]), v.point(*entries[1])});
    }
}

void readInto(const Value& value, const Setting& setting, Case& target) {
    if (const auto* const choice = std::get_if<FlowChoice>(&setting.field)) {
        bool chosen = false;
        read(value, chosen);
        Flow& flow = target.options.domain.flow;
        if (chosen && flow != Flow::automatic && flow != choice->value)
            value.refuse(value.node, "external and internal exclude each other",
                         "set one of the two to false");
        if (chosen) flow = choice->value;
        return;
    }
    std::visit(
        [&](const auto& field) {
            if constexpr (!std::is_same_v<std::decay_t<decltype(field)>, FlowChoice>)
                read(value, field(target));
        },
        setting.field);
}

// Files are named relative to the case file, so that a case can be run from anywhere.
void resolveFiles(std::vector<std::string>& files, const std::string& path) {
    const std::filesystem::path folder = std::filesystem::path(path).parent_path();
    for (std::string& file : files) file = (folder / file).string();
}

std::string quoted(const std::string& text) {
    std::ostringstream out;
    out << toml::value<std::string>(text);
    return out.str();
}

std::string show(double value) { return fmt::format("{}", value); }
std::string show(int value) { return fmt::format("{}", value); }
std::string show(bool value) { return value ? "true" : "false"; }
std::string show(const std::string& value) { return quoted(value); }
std::string show(LayerUnit unit) { return quoted(std::string(nameOf(unit))); }
std::string show(BoxEdges edges) { return quoted(std::string(nameOf(edges))); }
std::string show(const Vec3& p) { return fmt::format("[{}, {}, {}]", p.x, p.y, p.z); }
std::string show(const Box& b) {
    return fmt::format("[{}, {}, {}, {}, {}, {}]", b.lo.x, b.lo.y, b.lo.z, b.hi.x, b.hi.y, b.hi.z);
}
std::string showSize(const Vec3& s) { return s == sameSize(s.x) ? show(s.x) : show(s); }
template <class T, class V>
std::string showEntry(const T& item, const Entry<T, V>& entry) {
    if constexpr (std::is_same_v<V, Vec3>) {
        if (entry.size) return fmt::format("{} = {}", entry.name, showSize(item.*(entry.member)));
    }
    return fmt::format("{} = {}", entry.name, show(item.*(entry.member)));
}
template <class T>
    requires HasEntries<std::vector<T>>::value
std::string show(const T& item) {
    return std::apply(
        [&](const auto&... entry) {
            const std::vector<std::string> texts{showEntry(item, entry)...};
            return fmt::format("{{ {} }}", fmt::join(texts, ", "));
        },
        entriesOf(item));
}
std::string show(const Seed& s) {
    return fmt::format("{{ name = {}, place = {} }}", quoted(s.name), show(s.place));
}
template <class T>
std::string show(const std::vector<T>& items) {
    std::vector<std::string> texts;
    for (const T& item : items) texts.push_back(show(item));
    return fmt::format("[{}]", fmt::join(texts, ", "));
}

std::string assignment(const Setting& setting, Case& given) {
    if (const auto* const choice = std::get_if<FlowChoice>(&setting.field))
        return fmt::format("{} = {}\n", setting.key, given.options.domain.flow == choice->value);
    // TOML has no null: an absent box is a comment that shows how to write one.
    if (std::holds_alternative<FieldOf<std::optional<Box>>>(setting.field) && !given.options.domain.box)
        return fmt::format("# {} = [x0, y0, z0, x1, y1, z1]\n", setting.key);
    return std::visit(
        [&](const auto& field) -> std::string {
            using F = std::decay_t<decltype(field)>;
            if constexpr (std::is_same_v<F, FlowChoice>)
                return "";
            else if constexpr (std::is_same_v<F, FieldOf<std::optional<Box>>>)
                return fmt::format("{} = {}\n", setting.key, show(*field(given)));
            else
                return fmt::format("{} = {}\n", setting.key, show(field(given)));
        },
        setting.field);
}

[[noreturn]] void refuseKey(const toml::key& at, std::string_view name, const std::string& path,
                            std::string_view near) {
    throw Error(ErrorKind::usage, fmt::format("unknown key '{}'", name),
                fmt::format("{}:{}, key {}", path, at.source().begin.line, name),
                near.empty() ? "i2b mesh --write-case prints all keys" : fmt::format("write {}", near));
}

// [size], [[size.box]], [feature] and the like: the same settings under shorter names.
void readTable(std::string_view title, const toml::table& table, const std::string& path, Case& result) {
    for (const auto& [key, node] : table) {
        const Setting* const setting = findInTable(title, key.str());
        const std::string name = fmt::format("{}.{}", title, key.str());
        if (!setting && findSetting(key.str()))
            throw Error(ErrorKind::usage, fmt::format("the key '{}' has no place in the table [{}]", key.str(), title),
                        fmt::format("{}:{}, key {}", path, key.source().begin.line, name),
                        "write it before the first table");
        if (!setting) refuseKey(key, name, path, nearestInTable(title, key.str()));
        const auto before = result.lines.find(std::string(setting->key));
        if (before != result.lines.end())
            throw Error(ErrorKind::usage, fmt::format("{} and {} are the same", setting->key, name),
                        fmt::format("{}:{}, key {}", path, key.source().begin.line, name),
                        fmt::format("give one of the two ({} is in line {})", setting->key, before->second));
        readInto({node, name, path}, *setting, result);
        result.lines[std::string(setting->key)] = static_cast<int>(key.source().begin.line);
    }
}

} // namespace

Case parseCase(std::string_view text, const std::string& path) {
    toml::table table;
    try {
        table = toml::parse(text, path);
    } catch (const toml::parse_error& fault) {
        throw Error(ErrorKind::usage, std::string(fault.description()),
                    fmt::format("{}:{}", path, fault.source().begin.line), "correct the TOML there");
    }
    Case result;
    result.file = path;
    for (const auto& [key, node] : table) {
        if (isTable(key.str()) && node.is_table()) continue;
        const Setting* const setting = findSetting(key.str());
        if (!setting) refuseKey(key, key.str(), path, nearestKey(key.str()));
        readInto({node, setting->key, path}, *setting, result);
        result.lines[std::string(setting->key)] = static_cast<int>(key.source().begin.line);
    }
    for (const auto& [key, node] : table)
        if (isTable(key.str()) && node.is_table()) readTable(key.str(), *node.as_table(), path, result);
    resolveFiles(result.options.geometry.files, path);
    resolveFiles(result.options.geometry.featureLines, path);
    return result;
}

Case readCaseFile(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file.is_open() || std::filesystem::is_directory(path))
        throw Error(ErrorKind::usage, "the case file cannot be read", path, "check its name and permissions");
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    return parseCase(text, path);
}

std::string formatCase(const Case& given) {
    Case copy = given;
    std::string text = "# i2b case. Lengths are in metres, after scale.\n";
    for (const Setting& setting : settings())
        text += fmt::format("\n# {}\n{}", setting.help, assignment(setting, copy));
    return text;
}

} // namespace i2b
