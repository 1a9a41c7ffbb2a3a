// A vector whose resize() leaves plain values as they are: large arrays that a parallel loop fills next are
// then touched, and their pages fetched, by that loop instead of one thread.
#pragma once
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

namespace i2b {

template <class T>
struct RawAllocator : std::allocator<T> {
    static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);
    template <class U>
    struct rebind {
        using other = RawAllocator<U>;
    };
    template <class U>
    void construct(U*) noexcept {}
    template <class U, class... Args>
    void construct(U* place, Args&&... args) {
        ::new (static_cast<void*>(place)) U(std::forward<Args>(args)...);
    }
};

template <class T>
using RawVector = std::vector<T, RawAllocator<T>>;

} // namespace i2b
