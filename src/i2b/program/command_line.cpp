#include "i2b/program/command_line.h"
#include "i2b/core/error.h"
#include "i2b/program/case_file.h"
#include "i2b/program/edits.h"
#include "i2b/program/entries.h"
#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace i2b {
namespace {

[[noreturn]] void refuse(const std::string& option, const std::string& what, const std::string& remedy) {
    throw Error(ErrorKind::usage, what, option, remedy);
}

using Edits = std::vector<std::pair<std::string, Edit>>; // key, what it does to the case

// The default as the help shows it; nothing where it says nothing.
std::string defaultOf(const Setting& setting) {
    Case fresh;
    if (const auto* const f = std::get_if<FieldOf<double>>(&setting.field))
        return fmt::format("{}", (*f)(fresh));
    if (const auto* const f = std::get_if<FieldOf<int>>(&setting.field))
        return fmt::format("{}", (*f)(fresh));
    if (const auto* const f = std::get_if<FieldOf<LayerUnit>>(&setting.field)) return std::string(nameOf((*f)(fresh)));
    if (const auto* const f = std::get_if<FieldOf<std::string>>(&setting.field)) return (*f)(fresh);
    if (const auto* const f = std::get_if<FieldOf<std::vector<std::string>>>(&setting.field))
        return fmt::format("{}", fmt::join((*f)(fresh), ","));
    return "";
}

template <class T>
struct IsItemList : std::false_type {};
template <class T>
struct IsItemList<FieldOf<std::vector<T>>> : std::bool_constant<!std::is_same_v<T, std::string>> {};
template <>
struct IsItemList<RepeatedTexts> : std::true_type {};

// Lists that a repeated option adds to.
bool isRepeatable(const Setting& setting) {
    return std::visit([](const auto& field) { return IsItemList<std::decay_t<decltype(field)>>::value; },
                      setting.field);
}

// Forgets what the case file gave for a list.
void clearList(const Setting& setting, Case& given) {
    std::visit(
        [&](const auto& field) {
            if constexpr (IsItemList<std::decay_t<decltype(field)>>::value) field(given).clear();
        },
        setting.field);
}

void addSetting(CLI::App& app, const Setting& setting, Edits& edits) {
    const std::string name = fmt::format("--{}", setting.key);
    const auto record = [&edits, &setting](const std::string& text) {
        edits.emplace_back(setting.key, toEdit(setting, text));
    };
    if (setting.value.empty()) {
        app.add_flag_function(
            name, [record](std::int64_t count) { record(count > 0 ? "true" : "false"); },
            std::string(setting.help));
        return;
    }
    const std::string fallback = defaultOf(setting);
    CLI::Option* const option = app.add_option_function<std::vector<std::string>>(
        name,
        [record](const std::vector<std::string>& texts) {
            for (const auto& t : texts) record(t);
        },
        std::string(setting.help) +
            (fallback.empty() || setting.key == "size" ? "" : fmt::format(" [{}]", fallback)));
    option->type_name(std::string(setting.value))->expected(1)->allow_extra_args(false);
    option->multi_option_policy(isRepeatable(setting) ? CLI::MultiOptionPolicy::TakeAll
                                                      : CLI::MultiOptionPolicy::TakeLast);
}

struct Parser {
    CLI::App app{"Polyhedral CFD meshes from dirty geometry, from the interior to the boundary."};
    CommandLine line;
    std::vector<std::string> files;
    Edits edits;

    CLI::App& command(const std::string& name, const std::string& help, Command which) {
        CLI::App& sub = *app.add_subcommand(name, help);
        sub.callback([this, which] { line.command = which; });
        return sub;
    }

    void addMesher(const std::string& name, const std::string& help, Command which) {
        CLI::App& sub = command(name, help, which);
        sub.add_option("files", files, "CASE.toml, or the geometry files")->type_name("FILE");
        for (const Setting& setting : settings())
            if (setting.key != "geometry") addSetting(sub, setting, edits);
        sub.get_option("--external")->excludes("--internal");
        sub.add_flag("--write-case", line.writeCase,
                     "Print the complete case file for this command line and stop");
    }

    void addShared(CLI::App& sub, std::initializer_list<const char*> keys) {
        for (const char* key : keys) addSetting(sub, *findSetting(key), edits);
    }

    Parser() {
        app.require_subcommand(1);
        app.failure_message(CLI::FailureMessage::simple);
        app.set_version_flag("--version", "i2b " I2B_VERSION);
        addMesher("mesh", "Make the whole mesh", Command::mesh);
        addMesher("grid", "Make the Cartesian grid alone and write grid.vdb", Command::grid);
        addMesher("regions", "Show what would be painted: regions, seeds, leaks; with --out, also as grid.vdb and leaks.ply", Command::regions);
        CLI::App& inspect = command("inspect", "Show what the geometry holds", Command::inspect);
        inspect.add_option("files", files, "The geometry files")->type_name("FILE")->required();
        addShared(inspect, {"scale", "feature-angle", "feature-lines", "feature-part", "feature-box", "threads",
                            "quiet"});
        CLI::App& check = command("check", "Measure the quality of any OpenFOAM polyMesh", Command::check);
        check.add_option("case", line.caseFolder, "The OpenFOAM case, or its polyMesh folder")->required();
        check.add_option("--geometry", files, "Measure also how well the walls fit these files")
            ->type_name("FILE...");
        check
            .add_option("--patch", line.patches,
                        "Of the fit: this patch alone (whole name or regular expression); repeatable")
            ->type_name("NAME")
            ->expected(1)
            ->allow_extra_args(false)
            ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
            ->needs("--geometry");
        check.add_option("--case", line.limitsFile, "A case file, for the limits in its table [quality]")->type_name("CASE.toml");
        addShared(check, {"scale", "feature-angle", "feature-lines", "feature-part", "feature-box", "max-non-orthogonality", "min-pyramid-volume", "min-tet-quality",
                          "max-concavity", "min-face-area", "max-internal-skewness", "max-boundary-skewness",
                          "min-face-weight", "min-volume-ratio", "min-twist", "min-triangle-twist", "min-flatness",
                          "min-determinant", "threads", "quiet"});
        CLI::App& sample =
            command("sample", "Write a built-in geometry; without a name, list them", Command::sample);
        sample.add_option("name", line.sample, "Its name");
        sample
            .add_option("-o,--out", line.sampleFile,
                        "The .stl file to write, or a folder for a file per part")
            ->type_name("FILE");
        sample.add_option("--dirt", line.dirt, "Scales cracks and overlaps; 0: the clean twin [1]")
            ->type_name("F");
        sample
            .add_option("--resolution", line.resolution, "Multiplies the segments along curves, 1 to 8 [1]")
            ->type_name("N");
    }

    // Files to geometry or case file, then the command line's changes on top.
    void resolve() {
        const auto isCase = [](const std::string& f) { return f.ends_with(".toml"); };
        const auto caseFiles = std::ranges::count_if(files, isCase);
        const bool mesher = line.command == Command::mesh || line.command == Command::grid ||
                            line.command == Command::regions;
        if (caseFiles > 0 && !mesher)
            refuse(files.front(), "a case file is no geometry", "name geometry files");
        if (caseFiles > 0 && files.size() > 1)
            refuse("command line", "a case file and other files together",
                   "name one case file, or geometry files alone");
        if (caseFiles == 1)
            line.given = readCaseFile(files.front());
        else
            line.given.options.geometry.files = files;
        if (!line.limitsFile.empty()) line.given.options.quality = readCaseFile(line.limitsFile).options.quality;
        // A list given on the command line replaces the case file's.
        for (const auto& [key, edit] : edits) {
            if (line.given.lines.erase(key) > 0) clearList(*findSetting(key), line.given);
        }
        // So does a choice of flow: a seed asked for here is not refused because the file says external.
        for (const auto& [key, edit] : edits) {
            DomainOptions& domain = line.given.options.domain;
            if (key == "seed" && line.given.lines.erase("external") + line.given.lines.erase("internal") > 0)
                domain.flow = Flow::automatic;
            if ((key == "external" || key == "internal") && line.given.lines.erase("seed") > 0)
                domain.seeds.clear();
        }
        // And so do the two ways to the height of the first layer.
        for (const auto& [key, edit] : edits) {
            LayerOptions& layers = line.given.options.layers;
            if (key == "first-layer" && line.given.lines.erase("y-plus") > 0)
                layers.yPlus = layers.velocity = layers.viscosity = layers.length = 0;
            if (key == "y-plus" && line.given.lines.erase("first-layer") > 0) layers.first = 0;
        }
        for (const auto& [key, edit] : edits) {
            edit(line.given);
            line.outGiven = line.outGiven || key == "out";
        }
    }
};

} // namespace

CommandLine parseCommandLine(const std::vector<std::string>& arguments) {
    Parser parser;
    std::vector<std::string> reversed = joinNumbers(arguments);
    std::ranges::reverse(reversed); // CLI11 takes them from the back
    try {
        parser.app.parse(reversed);
    } catch (const CLI::CallForAllHelp&) {
        parser.line.text = parser.app.help("", CLI::AppFormatMode::All);
    } catch (const CLI::CallForVersion& version) {
        parser.line.text = std::string(version.what()) + "\n";
    } catch (const CLI::CallForHelp&) {
        parser.line.text = parser.app.help();
    } catch (const CLI::ParseError& fault) {
        const auto subs = parser.app.get_subcommands();
        throw Error(ErrorKind::usage, fault.what(), "command line",
                    fmt::format("see i2b {}--help", subs.empty() ? "" : subs.front()->get_name() + " "));
    }
    if (!parser.line.text.empty())
        parser.line.command = Command::help;
    else
        parser.resolve();
    return std::move(parser.line);
}

} // namespace i2b
