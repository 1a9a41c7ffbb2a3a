// Moves of columns around a zip (zip_star.h) until the faces of its cells divide into tetrahedra: descent by single columns, a coordinate at
// a time (a pattern search; Hooke and Jeeves 1961), of the sum of what face_tets.h and others find wanting.
#pragma once
#include "i2b/edit/zip_star.h"
#include "i2b/quality/dictionary_limits.h"

namespace i2b {

// Where points over the zip's columns should go, m, ascending by point; none where nothing helps. Changes nothing.
std::vector<std::pair<std::int32_t, Vec3>> shapeZip(const ZipStar& star, const Zip& zip, const DictionaryLimits& limits);

} // namespace i2b
