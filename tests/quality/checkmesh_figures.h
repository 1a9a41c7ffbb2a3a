// The figures in checkMesh's output, found by what they are called there, against those of a report.
#pragma once
#include "i2b/quality/quality_report.h"
#include <string>

namespace i2b::test {

// Expects each figure, count, patch, zone, region and set that output (of checkMesh -allTopology -allGeometry
// with a writePrecision of 17) names to be the report's, digit for digit, and those counts that it does not
// name to be zero.
void compareWithCheckMesh(const std::string& output, const QualityReport& report);

// Expects the number of faces that output (of checkMesh -meshQuality) names beside each limit to be the report's, and the
// limits that it does not name not to be asked.
void compareWithMeshQuality(const std::string& output, const QualityReport& report);

} // namespace i2b::test
