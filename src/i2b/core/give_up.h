// Gives up what a container holds, its memory too, which v = {} and v.clear() keep.
#pragma once

namespace i2b {

template <class... Containers>
void giveUp(Containers&... containers) {
    (Containers().swap(containers), ...);
}

} // namespace i2b
