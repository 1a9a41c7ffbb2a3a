#include "i2b/geometry/weld.h"
#include "i2b/core/parallel.h"
#include <atomic>
#include <bit>
#include <memory>

namespace i2b {
namespace {

constexpr std::uint32_t none = ~std::uint32_t{0};
constexpr std::size_t chunk = 1 << 14;

// Adding 0 makes -0 into 0, so that equal numbers have equal bits.
std::uint64_t bitsOf(double x) { return std::bit_cast<std::uint64_t>(x + 0.0); }

std::uint64_t hashOf(const Vec3& p, std::uint64_t seed) {
    std::uint64_t h = (bitsOf(p.x) ^ seed) * 0x9E3779B97F4A7C15u;
    h = ((h ^ (h >> 32)) + bitsOf(p.y)) * 0xC2B2AE3D27D4EB4Fu;
    h = ((h ^ (h >> 29)) + bitsOf(p.z)) * 0x165667B19E3779F9u;
    return h ^ (h >> 32);
}

void lowerTo(std::atomic<std::uint32_t>& slot, std::uint32_t i) {
    std::uint32_t seen = slot.load(std::memory_order_relaxed);
    while (i < seen && !slot.compare_exchange_weak(seen, i, std::memory_order_relaxed)) {
    }
}

// For each point the lowest number among its equals. The slot a key ends in depends on the race, what it
// holds does not.
std::vector<std::uint32_t> firstEquals(const std::vector<Vec3>& points,
                                       const std::vector<std::int32_t>& partOf) {
    const std::size_t size = std::bit_ceil(points.size() + points.size() / 2 + 2), mask = size - 1;
    const std::unique_ptr<std::atomic<std::uint32_t>[]> table(new std::atomic<std::uint32_t>[size]);
    parallelFor(
        size, [&](std::size_t s) { table[s].store(none, std::memory_order_relaxed); }, chunk);
    std::vector<std::uint32_t> result(points.size());
    parallelFor(
        points.size(),
        [&](std::size_t i) {
            const auto self = static_cast<std::uint32_t>(i);
            std::size_t s = hashOf(points[i], static_cast<std::uint64_t>(partOf[i])) & mask;
            for (;; s = (s + 1) & mask) {
                std::uint32_t other = table[s].load(std::memory_order_relaxed);
                if (other == none && table[s].compare_exchange_strong(other, self, std::memory_order_relaxed))
                    break;
                if (points[other] == points[i] && partOf[other] == partOf[i]) {
                    lowerTo(table[s], self);
                    break;
                }
            }
            result[i] = static_cast<std::uint32_t>(s);
        },
        chunk);
    parallelFor(
        result.size(), [&](std::size_t i) { result[i] = table[result[i]].load(std::memory_order_relaxed); },
        chunk);
    return result;
}

} // namespace

PieceWelder::PieceWelder(std::vector<Vec3>& points)
    : points_(points), slots_(1 << 12, none), first_(static_cast<std::uint32_t>(points.size())) {}

void PieceWelder::startPart() { first_ = static_cast<std::uint32_t>(points_.size()); }

std::uint32_t PieceWelder::add(const Vec3& point) {
    if ((points_.size() - first_) * 2 >= slots_.size()) grow();
    const std::size_t mask = slots_.size() - 1;
    std::size_t s = hashOf(point, 0) & mask;
    for (;; s = (s + 1) & mask) {
        const std::uint32_t i = slots_[s];
        if (i < first_ || i == none) break; // empty, or of an earlier part and free to be taken
        if (points_[i] == point) return i;
    }
    slots_[s] = static_cast<std::uint32_t>(points_.size());
    points_.push_back(point);
    return slots_[s];
}

void PieceWelder::grow() {
    slots_.assign(slots_.size() * 4, none);
    const std::size_t mask = slots_.size() - 1;
    for (std::size_t i = first_; i < points_.size(); ++i) {
        std::size_t s = hashOf(points_[i], 0) & mask;
        while (slots_[s] != none) s = (s + 1) & mask;
        slots_[s] = static_cast<std::uint32_t>(i);
    }
}

void weldPoints(std::vector<Vec3>& points, const std::vector<std::int32_t>& partOf,
                std::vector<std::array<std::uint32_t, 3>>& triangles) {
    const std::size_t n = points.size(), chunks = (n + chunk - 1) / chunk;
    std::vector<std::uint32_t> first = firstEquals(points, partOf);
    std::vector<std::uint32_t> offset(chunks);
    parallelChunks(n, chunk, [&](std::size_t begin, std::size_t end, std::size_t c) {
        for (std::size_t i = begin; i != end; ++i) offset[c] += first[i] == i;
    });
    const std::uint32_t kept = exclusiveScan(offset);
    if (kept == n) return;
    std::vector<Vec3> welded(kept);
    std::vector<std::uint32_t> number(n);
    parallelChunks(n, chunk, [&](std::size_t begin, std::size_t end, std::size_t c) {
        std::uint32_t next = offset[c];
        for (std::size_t i = begin; i != end; ++i)
            if (first[i] == i) welded[next] = points[i], number[i] = next++;
    });
    points = std::move(welded);
    parallelFor(
        triangles.size(),
        [&](std::size_t t) {
            for (std::uint32_t& v : triangles[t]) v = number[first[v]];
        },
        chunk);
}

} // namespace i2b
