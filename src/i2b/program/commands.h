// Runs what a command line asks for. The program's main() is this and nothing else.
#pragma once
#include <cstdio>
#include <string>
#include <vector>

namespace i2b {

// arguments without the program's name. Results go to out, progress and errors to err. Returns the exit
// status: 0 done; 1 the input cannot be meshed as asked, or a checked mesh fails; 2 the command line or case
// file is wrong; 3 a fault of ours; 130 interrupted.
int runProgram(const std::vector<std::string>& arguments, std::FILE* out, std::FILE* err);

} // namespace i2b
