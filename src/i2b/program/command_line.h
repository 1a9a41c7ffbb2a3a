// What a command line asks for. Options given on it override those of its case file.
#pragma once
#include "i2b/program/settings.h"
#include <string>
#include <vector>

namespace i2b {

enum class Command { help, mesh, grid, regions, inspect, check, sample };

struct CommandLine {
    Command command = Command::help;
    std::string text;       // help: what to print
    Case given;             // mesh, grid, regions; inspect and check use its geometry, threads and quiet, check its quality, too
    bool outGiven = false;  // --out is named on the command line itself
    bool writeCase = false; // mesh, grid, regions: print the case file instead of running
    std::string caseFolder; // check: an OpenFOAM case
    std::string limitsFile; // check: the case file that the limits come from; empty: none
    std::vector<std::string> patches; // check: names or expressions of those whose fit is measured; empty: all walls
    std::string sample;     // sample: the name of a built-in geometry; empty: list them
    std::string sampleFile; // sample: the .stl file to write, or a folder for a file per part
    double dirt = 1;        // sample: scales cracks and overlaps; 0: clean
    int resolution = 1;     // sample: multiplies the segments along curves
};

// arguments without the program's name. Reads the case file if one is named. Throws Error (usage).
CommandLine parseCommandLine(const std::vector<std::string>& arguments);

} // namespace i2b
