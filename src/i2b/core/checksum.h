// A 64-bit checksum of products (XXH3), the same on any number of threads. For comparing results, not for security.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

namespace i2b {

class Checksum {
  public:
    void bytes(const void* data, std::size_t size);
    template <class T>
    void add(std::span<const T> values) {
        static_assert(std::is_trivially_copyable_v<T>);
        const std::uint64_t n = values.size();
        bytes(&n, sizeof n);
        bytes(values.data(), values.size_bytes());
    }
    template <class T>
        requires std::is_arithmetic_v<T> || std::is_enum_v<T>
    void add(T value) { bytes(&value, sizeof value); }
    void add(std::string_view text);

    std::uint64_t value() const { return state_; }
    std::string hex() const; // 16 lower-case digits

  private:
    std::uint64_t state_ = 0;
};

} // namespace i2b
