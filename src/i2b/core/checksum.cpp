#include "i2b/core/checksum.h"
#include <fmt/format.h>
#define XXH_INLINE_ALL
#include <xxhash.h>

namespace i2b {

void Checksum::bytes(const void* data, std::size_t size) { state_ = XXH3_64bits_withSeed(data, size, state_); }

void Checksum::add(std::string_view text) { add(std::span<const char>(text.data(), text.size())); }

std::string Checksum::hex() const { return fmt::format("{:016x}", state_); }

} // namespace i2b
