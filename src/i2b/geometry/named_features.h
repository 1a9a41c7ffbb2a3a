// What the user names beyond the angle: parts, boxes, lines. Step 6 of features.cpp; private to it.
#pragma once
#include "i2b/geometry/feature_soup.h"

namespace i2b {

// Degrees above which an edge at p is sharp: inside boxes what the last one says.
double angleAt(const FeatureOptions& options, const Vec3& p);

// Per part whether one of the names means it. A name without a part is noted.
std::vector<bool> namedParts(const std::vector<Part>& parts, const std::vector<std::string>& names,
                             std::vector<std::string>& notes);

// Names the edges that the soup's lines run along, and adds those that no triangle has. edges: a < b, ascending,
// before and after.
void addLines(const FeatureSoup& soup, RawVector<FeatureEdge>& edges);

// Judges the edges inside boxes anew, by the last box that holds them; where boxes of different kinds begin or end
// inside an edge, it is cut: new points come at the end of the soup's. No piece is shorter than tolerance (m). The soup's
// lines stay as they are. Order as above.
void applyBoxes(const std::vector<FeatureBox>& boxes, double tolerance, FeatureSoup& soup,
                RawVector<FeatureEdge>& edges);

// Ascending, each once.
void addCorners(const std::vector<std::uint32_t>& more, std::vector<std::uint32_t>& corners);

// Lines that lie apart from the geometry are mostly in another unit.
void noteFarLines(const Surface& surface, const FeatureLines& lines, std::vector<std::string>& notes);

} // namespace i2b
