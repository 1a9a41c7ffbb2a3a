#include "i2b/grid/ranked_mask.h"

namespace i2b {

RankedMask::RankedMask(Mask::ConstPtr mask, std::int64_t first) : mask_(std::move(mask)), first_(first) {
    leaves_ = leavesOf(*mask_);
    starts_.resize(leaves_.size()), before_.resize(leaves_.size());
    parallelFor(leaves_.size(), [&](std::size_t i) {
        int n = 0;
        for (std::size_t w = 0; w < 8; ++w) {
            before_[i][w] = static_cast<std::uint16_t>(n);
            n += std::popcount(leaves_[i]->getValueMask().getWord<openvdb::Index64>(static_cast<openvdb::Index>(w)));
        }
        starts_[i] = n;
    });
    size_ = exclusiveScan(starts_);
    index_ = std::make_shared<openvdb::Int32Tree>(-1);
    openvdb::tree::ValueAccessor<openvdb::Int32Tree> write(*index_);
    for (std::size_t i = 0; i < leaves_.size(); ++i) {
        const openvdb::Coord& o = leaves_[i]->origin();
        write.setValue({o.x() >> 3, o.y() >> 3, o.z() >> 3}, static_cast<std::int32_t>(i));
    }
}

} // namespace i2b
