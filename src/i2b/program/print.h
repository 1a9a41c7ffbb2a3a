// What the commands print about their products, as lines of text that end in a newline.
#pragma once
#include "i2b/paint/regions.h"
#include "i2b/quality/fit_report.h"
#include "i2b/write/report.h"
#include <string>
#include <vector>

namespace i2b {

std::string fitText(const FitReport& fit);
// A line for each region, the largest first, with a seed to paint it from; then the leaks. Regions of less
// than a millionth of the largest volume are only counted.
// One region in a line, for programs to read: "volume V box X0 Y0 Z0 X1 Y1 Z1 seed X Y Z domain-box yes painted no parts
// NAME NAME ...". Lengths in metres; the names of parts hold no blanks.
std::string regionRecord(const Region& region, const std::vector<ReportPart>& parts);

std::string regionsText(const Regions& regions, const std::vector<ReportPart>& parts);
// A few lines on a run: cells, time, memory, quality, fit, layers.
std::string summaryText(const RunReport& report);

} // namespace i2b
