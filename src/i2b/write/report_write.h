// report.json with the keys of the program's contract, in their order; numbers that are not finite become
// null.
#pragma once
#include "i2b/write/report.h"
#include <filesystem>
#include <string>

namespace i2b {

// Indented text with a final line end. Bytes that are not UTF-8 (file names) become the replacement
// character.
std::string reportText(const RunReport& report);

// Throws Error{input} where the file cannot be written.
void writeReport(const RunReport& report, const std::filesystem::path& path);

} // namespace i2b
