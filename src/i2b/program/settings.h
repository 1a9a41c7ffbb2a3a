// Every option of a run, once: its key (the same word in a case file and, with "--", on the command line),
// what it means, and the field it sets. Reading and writing case files, the command line, its help and the
// README's table all go over this list.
#pragma once
#include "i2b/options.h"
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace i2b {

// A run as asked for: the options of the library, what only the program needs, and where each key was set.
struct Case {
    Options options;
    bool quiet = false;
    std::string file;                 // the case file read; empty without one
    std::map<std::string, int> lines; // of the keys that the file sets, from 1
};

template <class T>
using FieldOf = T& (*)(Case&);

struct FlowChoice {
    Flow value; // the setting is true where DomainOptions::flow is this
};

// Texts that may hold commas: each comes with an option of its own, where the others of a list follow a comma.
struct RepeatedTexts {
    FieldOf<std::vector<std::string>> field;
    std::vector<std::string>& operator()(Case& c) const { return field(c); }
};

using Field = std::variant<FieldOf<double>, FieldOf<int>, FieldOf<bool>, FieldOf<std::string>,
                           FieldOf<std::vector<std::string>>, RepeatedTexts, FieldOf<std::vector<PartSize>>,
                           FieldOf<std::vector<BoxSize>>, FieldOf<std::vector<SphereSize>>,
                           FieldOf<std::vector<CylinderSize>>, FieldOf<std::vector<BandSize>>,
                           FieldOf<std::vector<PointSize>>, FieldOf<std::vector<SegmentSize>>,
                           FieldOf<std::vector<LineSize>>, FieldOf<std::vector<FeatureBox>>,
                           FieldOf<std::vector<Seed>>,
                           FieldOf<std::vector<PartLayers>>, FieldOf<LayerUnit>,
                           FieldOf<std::optional<Box>>, FlowChoice>;

struct Setting {
    std::string_view key;
    std::string_view value; // what follows the option on the command line; empty for a switch
    std::string_view help;  // with the unit
    Field field;
    std::string_view table = {};   // of a case file, [size], [layer], [quality] and so on, where it may stand, too; empty: none
    std::string_view inTable = {}; // what it is called there
};

// In the order of the case file.
std::span<const Setting> settings();
const Setting* findSetting(std::string_view key);
bool isTable(std::string_view name);
const Setting* findInTable(std::string_view table, std::string_view key); // by its name there
// The known key that a misspelt one most likely means; empty if none is near.
std::string_view nearestKey(std::string_view key);
std::string_view nearestInTable(std::string_view table, std::string_view key);

} // namespace i2b
