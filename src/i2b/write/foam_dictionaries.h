// The dictionaries of a minimal case, as text: enough for checkMesh, potentialFoam and a first simpleFoam
// run.
#pragma once
#include <string>
#include <string_view>

namespace i2b {

// The opening of an OpenFOAM file; `note` goes into it unless empty.
std::string foamHeader(std::string_view className, std::string_view location, std::string_view object,
                       bool binary, std::string_view note);

std::string controlDictText(std::string_view note);
std::string fvSchemesText(std::string_view note);
std::string fvSolutionText(std::string_view note);

} // namespace i2b
