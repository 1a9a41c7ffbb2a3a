// Cuts faces of a front into several.
#pragma once
#include "i2b/front/front.h"

namespace i2b {

struct FaceCut {
    std::int32_t face = 0;
    std::vector<std::vector<std::int32_t>> polygons; // vertices, in the sense of the face; 2 or more polygons, or one
                                                     // with further vertices on its edges
};

// cuts: by ascending face. Vertices keep their numbers; faces are numbered anew, in the order of before.
void replaceFaces(Front& front, const std::vector<FaceCut>& cuts);

} // namespace i2b
