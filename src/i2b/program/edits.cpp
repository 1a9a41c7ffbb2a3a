#include "i2b/program/edits.h"
#include "i2b/core/error.h"
#include "i2b/program/entries.h"
#include <charconv>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <map>

namespace i2b {
namespace {

[[noreturn]] void refuse(const std::string& option, const std::string& what, const std::string& remedy) {
    throw Error(ErrorKind::usage, what, option, remedy);
}

std::vector<std::string> split(const std::string& text) {
    std::vector<std::string> items{""};
    for (const char c : text) {
        if (c == ',')
            items.emplace_back();
        else
            items.back() += c;
    }
    return items;
}

bool isNumber(std::string_view text) {
    if (text.starts_with('+')) text.remove_prefix(1);
    double value = 0;
    const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
    return fault == std::errc() && end == text.data() + text.size();
}

double toNumber(const std::string& option, const std::string& text) {
    if (!isNumber(text)) refuse(option, fmt::format("'{}' is no number", text), "give a number");
    return std::stod(text);
}

std::vector<double> toNumbers(const std::string& option, const std::string& text, std::size_t count) {
    std::vector<double> numbers;
    for (const std::string& item : split(text)) numbers.push_back(toNumber(option, item));
    if (numbers.size() != count)
        refuse(option, fmt::format("{} numbers where {} are needed", numbers.size(), count),
               fmt::format("give {} numbers", count));
    return numbers;
}

Box toBox(const std::vector<double>& v) { return {{v[0], v[1], v[2]}, {v[3], v[4], v[5]}}; }

// The numbers at the end of "TEXT,1,2,3" or in "1,2,3", which leave the text. It may hold commas itself, so they are
// taken from the back; without a text every item is one.
std::vector<double> takeNumbers(const std::string& option, std::string& text, std::size_t most, bool named) {
    std::vector<double> numbers;
    while (!text.empty() && numbers.size() <= most) {
        const std::size_t comma = text.rfind(',');
        if (named && (comma == std::string::npos || !isNumber(text.substr(comma + 1)))) break;
        const std::size_t begin = comma == std::string::npos ? 0 : comma + 1;
        numbers.insert(numbers.begin(), toNumber(option, text.substr(begin)));
        text.resize(begin > 0 ? comma : 0);
    }
    return numbers;
}

template <class T>
struct ItemShape {
    std::size_t numbers = 0; // with one size for each axis
    bool named = false;      // begins with a text

    ItemShape() {
        std::apply([&](const auto&... entry) { (look(entry), ...); }, entriesOf(T{}));
    }
    template <class V>
    void look(const Entry<T, V>&) {
        numbers += numbersIn<V>();
        named = named || std::is_same_v<V, std::string>;
    }
};

// The entries of one item in order; the size, which comes last, is one number or three.
template <class T>
T toItem(const std::string& option, std::string text) {
    const ItemShape<T> shape;
    const std::vector<double> v = takeNumbers(option, text, shape.numbers, shape.named);
    if (v.size() != shape.numbers && v.size() != shape.numbers - 2)
        refuse(option, fmt::format("{} numbers where {} are needed", v.size(), shape.numbers - 2),
               fmt::format("give {} numbers, or {} with one size for each axis", shape.numbers - 2, shape.numbers));
    T item;
    const double* next = v.data();
    const auto take = [&](auto& value, bool oneForAll) {
        using V = std::decay_t<decltype(value)>;
        if constexpr (std::is_same_v<V, std::string>) value = text;
        if constexpr (std::is_same_v<V, double>) value = *next;
        if constexpr (std::is_same_v<V, Box>) value = {{next[0], next[1], next[2]}, {next[3], next[4], next[5]}};
        if constexpr (std::is_same_v<V, Vec3>) value = oneForAll ? sameSize(*next) : Vec3{next[0], next[1], next[2]};
        next += oneForAll ? 1 : numbersIn<V>();
    };
    const bool one = v.size() != shape.numbers;
    std::apply([&](const auto&... e) { (take(item.*(e.member), e.size && one), ...); }, entriesOf(item));
    return item;
}

// "PART=N,first=H,thickness=T,growth=R", taken from the back: an expression may hold commas and = itself.
PartLayers toPartLayers(const std::string& option, std::string text) {
    const std::string form = "write PART=N or PART=none, and after it any of ,first=H ,thickness=T ,growth=R";
    PartLayers rule;
    const std::map<std::string, double PartLayers::*, std::less<>> figures{
        {"first", &PartLayers::first}, {"thickness", &PartLayers::thickness}, {"growth", &PartLayers::growth}};
    for (;;) {
        const std::size_t equals = text.rfind('=');
        if (equals == std::string::npos || equals == 0) refuse(option, "the number of layers is missing", form);
        const std::string value = text.substr(equals + 1);
        const std::size_t comma = text.rfind(',', equals);
        const auto figure = comma == std::string::npos ? figures.end() : figures.find(text.substr(comma + 1, equals - comma - 1));
        text.resize(figure == figures.end() ? equals : comma);
        if (figure != figures.end()) {
            rule.*(figure->second) = toNumber(option, value);
            continue;
        }
        const std::size_t before = comma == std::string::npos ? comma : text.rfind('=', comma);
        if (before != std::string::npos && (isNumber(text.substr(before + 1, comma - before - 1)) || text.compare(before + 1, comma - before - 1, "none") == 0))
            refuse(option, fmt::format("'{}' is no figure of layers", text.substr(comma + 1)), form);
        rule.part = text;
        const auto [end, fault] = std::from_chars(value.data(), value.data() + value.size(), rule.count);
        if (value == "none")
            rule.count = 0;
        else if (fault != std::errc() || end != value.data() + value.size())
            refuse(option, fmt::format("'{}' is no whole number", value), form);
        return rule;
    }
}

// The text after an option to the change it stands for.
struct Visitor {
    const std::string &option, &text;

    template <class F, class V>
    static Edit set(F field, V value) {
        return [=](Case& c) { field(c) = value; };
    }
    Edit operator()(FieldOf<double> f) const { return set(f, toNumber(option, text)); }
    Edit operator()(FieldOf<int> f) const {
        int value = 0;
        const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
        if (fault != std::errc() || end != text.data() + text.size())
            refuse(option, fmt::format("'{}' is no whole number", text), "give a whole number");
        return set(f, value);
    }
    Edit operator()(FieldOf<bool> f) const { return set(f, text != "false"); }
    Edit operator()(FieldOf<std::string> f) const { return set(f, text); }
    Edit operator()(FieldOf<std::vector<std::string>> f) const {
        return set(f, split(text));
    }
    Edit operator()(RepeatedTexts f) const {
        return [=, value = text](Case& c) { f(c).push_back(value); };
    }
    Edit operator()(FieldOf<std::optional<Box>> f) const {
        return set(f, std::optional<Box>(toBox(toNumbers(option, text, 6))));
    }
    Edit operator()(FieldOf<std::vector<PartSize>> f) const {
        const std::size_t equals = text.rfind('=');
        if (equals == std::string::npos) refuse(option, "a size is missing", "write PART=D");
        const PartSize value = toItem<PartSize>(option, text.substr(0, equals) + "," + text.substr(equals + 1));
        return [=](Case& c) { f(c).push_back(value); };
    }
    template <class T>
        requires HasEntries<std::vector<T>>::value
    Edit operator()(FieldOf<std::vector<T>> f) const {
        const T value = toItem<T>(option, text);
        return [=](Case& c) { f(c).push_back(value); };
    }
    Edit operator()(FieldOf<std::vector<FeatureBox>> f) const { // the word comes last
        const std::size_t comma = text.rfind(',');
        const std::string word = text.substr(comma == std::string::npos ? 0 : comma + 1);
        const auto edges = boxEdgesNamed(word);
        if (!edges)
            refuse(option, fmt::format("'{}' is neither all nor none", word), "write X0 Y0 Z0 X1 Y1 Z1 all, or none");
        const std::string numbers = comma == std::string::npos ? "" : text.substr(0, comma);
        const FeatureBox value{toBox(toNumbers(option, numbers, 6)), *edges};
        return [=](Case& c) { f(c).push_back(value); };
    }
    Edit operator()(FieldOf<LayerUnit> f) const {
        const auto unit = layerUnitNamed(text);
        if (!unit) refuse(option, fmt::format("'{}' is neither m nor cell", text), "write m or cell");
        return set(f, *unit);
    }
    Edit operator()(FieldOf<std::vector<PartLayers>> f) const {
        return [=, value = toPartLayers(option, text)](Case& c) { f(c).push_back(value); };
    }
    Edit operator()(FieldOf<std::vector<Seed>> f) const {
        const std::size_t equals = text.find('=');
        const auto v = toNumbers(option, equals == std::string::npos ? text : text.substr(equals + 1), 3);
        const Seed value{equals == std::string::npos ? "" : text.substr(0, equals), {v[0], v[1], v[2]}};
        return [=](Case& c) { f(c).push_back(value); };
    }
    Edit operator()(FlowChoice choice) const {
        return [=, on = text != "false"](Case& c) {
            Flow& flow = c.options.domain.flow;
            if (on)
                flow = choice.value;
            else if (flow == choice.value)
                flow = Flow::automatic;
        };
    }
};

} // namespace

Edit toEdit(const Setting& setting, const std::string& text) {
    const std::string option = fmt::format("--{}", setting.key);
    return std::visit(Visitor{option, text}, setting.field);
}

std::vector<std::string> joinNumbers(const std::vector<std::string>& arguments) {
    const std::map<std::string, std::size_t, std::less<>> counts{
        {"--seed", 3},         {"--keep-out", 3},     {"--box", 6},           {"--box-size", 9},   {"--sphere-size", 7},
        {"--cylinder-size", 10}, {"--point-size", 6}, {"--segment-size", 9}, {"--line-size", 9},
        {"--feature-box", 6}};
    std::vector<std::string> joined;
    for (std::size_t i = 0; i < arguments.size(); ++i) {
        joined.push_back(arguments[i]);
        if (!arguments[i].starts_with("--") || arguments[i].find('=') != std::string::npos) continue;
        if (arguments[i] == "--band-size" && i + 1 < arguments.size()) { // a text before the numbers
            std::vector<std::string> values{arguments[++i]};
            while (values.size() < 5 && i + 1 < arguments.size() && isNumber(arguments[i + 1]))
                values.push_back(arguments[++i]);
            joined.back() += fmt::format("={}", fmt::join(values, ","));
            continue;
        }
        const auto wanted = counts.find(arguments[i]);
        const std::size_t most = wanted == counts.end() ? 1 : wanted->second;
        std::vector<std::string> numbers;
        while (numbers.size() < most && i + 1 < arguments.size() && isNumber(arguments[i + 1]))
            numbers.push_back(arguments[++i]);
        const bool wordFollows = arguments[i - numbers.size()] == "--feature-box" && numbers.size() == most;
        if (wordFollows && i + 1 < arguments.size() && !arguments[i + 1].starts_with("--"))
            numbers.push_back(arguments[++i]);
        if (!numbers.empty()) joined.back() += fmt::format("={}", fmt::join(numbers, ","));
    }
    return joined;
}

} // namespace i2b
