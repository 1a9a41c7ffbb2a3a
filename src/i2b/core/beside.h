// Work that goes on beside what its owner does next, on the same threads: stages that wait for nothing but the geometry fill
// the idle moments of others. Its result does not depend on when it runs; with one thread it runs when it is asked for.
#pragma once
#include <functional>
#include <optional>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>
#include <utility>

namespace i2b {

template <class T>
class Beside {
  public:
    // work: begins now or later; what it refers to must outlive this object.
    explicit Beside(std::function<T()> work) : work_(std::move(work)) {
        group_.run([this] { result_.emplace(work_()); });
    }
    ~Beside() { // nothing may go on with what its owner is about to destroy
        try {
            group_.cancel();
            group_.wait();
        } catch (...) { // nobody asked for the result
        }
    }
    Beside(const Beside&) = delete;
    Beside& operator=(const Beside&) = delete;

    // Waits; throws what the work threw. Once.
    T get() {
        group_.wait();
        return std::move(*result_);
    }

  private:
    std::function<T()> work_;
    std::optional<T> result_;
    tbb::task_group group_;
};

// Runs body() such that loops in it that wait take up pieces of body() alone, not the whole of what was begun beside it.
template <class Body>
void apart(const Body& body) {
    tbb::this_task_arena::isolate(body);
}

} // namespace i2b
