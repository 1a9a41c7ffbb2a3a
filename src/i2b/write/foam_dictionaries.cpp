#include "i2b/write/foam_dictionaries.h"
#include <fmt/format.h>

namespace i2b {

std::string foamHeader(std::string_view className, std::string_view location, std::string_view object,
                       bool binary, std::string_view note) {
    std::string text = "FoamFile\n{\n    version     2.0;\n";
    text += fmt::format("    format      {};\n", binary ? "binary" : "ascii");
    text += fmt::format("    class       {};\n", className);
    if (binary) text += "    arch        \"LSB;label=32;scalar=64\";\n";
    if (!note.empty()) text += fmt::format("    note        \"{}\";\n", note);
    text += fmt::format("    location    \"{}\";\n    object      {};\n}}\n\n", location, object);
    return text;
}

std::string controlDictText(std::string_view note) {
    return foamHeader("dictionary", "system", "controlDict", false, note) + R"foam(application     simpleFoam;
startFrom       startTime;
startTime       0;
stopAt          endTime;
endTime         500;
deltaT          1;
writeControl    timeStep;
writeInterval   100;
purgeWrite      0;
writeFormat     binary;
writePrecision  8;
writeCompression off;
timeFormat      general;
timePrecision   6;
runTimeModifiable true;
)foam";
}

std::string fvSchemesText(std::string_view note) {
    return foamHeader("dictionary", "system", "fvSchemes", false, note) + R"foam(ddtSchemes
{
    default         steadyState;
}
gradSchemes
{
    default         cellLimited Gauss linear 1;
    grad(p)         Gauss linear;
    grad(Phi)       Gauss linear;
}
divSchemes
{
    default         bounded Gauss upwind;
    div(phi,U)      bounded Gauss linearUpwindV grad(U);
    div((nuEff*dev2(T(grad(U))))) Gauss linear;
    div(div(phi,U)) Gauss linear;
}
laplacianSchemes
{
    default         Gauss linear limited 0.5;
}
interpolationSchemes
{
    default         linear;
}
snGradSchemes
{
    default         limited 0.5;
}
wallDist
{
    method          meshWave;
}
)foam";
}

std::string fvSolutionText(std::string_view note) {
    return foamHeader("dictionary", "system", "fvSolution", false, note) + R"foam(solvers
{
    "(p|Phi)" {
        solver GAMG;
        smoother GaussSeidel;
        tolerance 1e-7;
        relTol 0.01;
    }
    "(U|k|omega|epsilon|nuTilda)" {
        solver smoothSolver;
        smoother GaussSeidel;
        tolerance 1e-8;
        relTol 0.1;
        nSweeps 1;
    }
}
potentialFlow { nNonOrthogonalCorrectors 10; }
SIMPLE {
    nNonOrthogonalCorrectors 0;
    consistent yes;
}
relaxationFactors {
    equations {
        U 0.9;
        ".*" 0.7;
    }
}
cache { grad(U); }
)foam";
}

} // namespace i2b
