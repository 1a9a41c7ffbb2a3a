#include "i2b/grid/ranked_mask.h"

namespace i2b {

RankedMask::RankedMask(Mask::ConstPtr mask, std::int64_t first) : mask_(std::move(mask)), first_(first) {
    leaves_ = leavesOf(*mask_);
    starts_.resize(leaves_.size());
    parallelFor(leaves_.size(), [&](std::size_t i) { starts_[i] = leaves_[i]->onVoxelCount(); });
    size_ = exclusiveScan(starts_);
    index_ = std::make_shared<openvdb::Int32Tree>(-1);
    openvdb::tree::ValueAccessor<openvdb::Int32Tree> write(*index_);
    for (std::size_t i = 0; i < leaves_.size(); ++i) {
        const openvdb::Coord& o = leaves_[i]->origin();
        write.setValue({o.x() >> 3, o.y() >> 3, o.z() >> 3}, static_cast<std::int32_t>(i));
    }
}

} // namespace i2b
