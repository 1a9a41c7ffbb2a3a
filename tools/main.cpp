// i2b: see `i2b --help`.
#include "i2b/program/commands.h"

int main(int argc, char** argv) {
    return i2b::runProgram(std::vector<std::string>(argv + 1, argv + argc), stdout, stderr);
}
