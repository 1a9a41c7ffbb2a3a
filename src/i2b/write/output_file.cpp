#include "i2b/write/output_file.h"
#include "i2b/core/error.h"
#include <algorithm>
#include <cerrno>
#include <cstring>
#include <deque>
#include <fcntl.h>
#include <fmt/format.h>
#include <mutex>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>
#include <unistd.h>
#include <vector>

namespace i2b {
namespace {

constexpr std::size_t bufferBytes = std::size_t(1) << 20;

struct Block {
    std::size_t index = 0;
    std::string bytes;
};

// Buffers go round, so that the pipeline touches fresh memory only at its start.
class BlockPool {
  public:
    Block* take(std::size_t index) {
        const std::scoped_lock lock(mutex_);
        if (idle_.empty()) idle_.push_back(&blocks_.emplace_back());
        Block* block = idle_.back();
        idle_.pop_back();
        block->index = index;
        block->bytes.clear();
        return block;
    }
    void give(Block* block) {
        const std::scoped_lock lock(mutex_);
        idle_.push_back(block);
    }

  private:
    std::mutex mutex_;
    std::deque<Block> blocks_;
    std::vector<Block*> idle_;
};

} // namespace

std::string humanBytes(std::uint64_t bytes) {
    static constexpr const char* units[] = {"B", "kB", "MB", "GB", "TB", "PB", "EB"};
    double value = static_cast<double>(bytes);
    std::size_t unit = 0;
    while (value >= 999.5 && unit + 1 < std::size(units)) value /= 1000, ++unit;
    return unit == 0 ? fmt::format("{} B", bytes) : fmt::format("{:.3g} {}", value, units[unit]);
}

std::uint64_t freeBytes(const std::filesystem::path& path) {
    std::error_code error;
    std::filesystem::path place = std::filesystem::absolute(path, error);
    while (!std::filesystem::exists(place, error) && place.has_relative_path()) place = place.parent_path();
    const auto space = std::filesystem::space(place, error);
    return error ? ~std::uint64_t(0) : space.available;
}

void throwSystemError(const std::string& doing, const std::filesystem::path& path, int error,
                      std::uint64_t written, std::uint64_t expected) {
    const std::string where = path.string();
    if (error == ENOSPC || error == EDQUOT) {
        std::string what = error == EDQUOT ? "the disk quota is used up" : "the disk is full";
        const std::uint64_t room = freeBytes(path);
        what += fmt::format(": {} of this file are written", humanBytes(written));
        if (expected > written) what += fmt::format(", {} more are needed", humanBytes(expected - written));
        what += fmt::format(", {} are free", humanBytes(room));
        throw Error(ErrorKind::input, what, where, "free some space or choose another folder with --out");
    }
    std::string remedy = "choose another folder with --out";
    if (error == EACCES || error == EPERM || error == EROFS)
        remedy = "choose a folder that you may write to with --out";
    throw Error(ErrorKind::input, fmt::format("cannot {}: {}", doing, std::strerror(error)), where, remedy);
}

OutputFile::OutputFile(std::filesystem::path path, std::uint64_t expectedBytes)
    : path_(std::move(path)), expected_(expectedBytes) {
    if (expected_ > 0 && freeBytes(path_) < expected_) throwSystemError("write", path_, ENOSPC, 0, expected_);
    descriptor_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (descriptor_ < 0) throwSystemError("create the file", path_, errno);
    buffer_.reserve(bufferBytes);
}

OutputFile::~OutputFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
}

void OutputFile::put(const char* data, std::size_t bytes) {
    while (bytes > 0) {
        const ssize_t n = ::write(descriptor_, data, bytes);
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) throwSystemError("write", path_, errno, written_, expected_);
        data += n;
        bytes -= static_cast<std::size_t>(n);
        written_ += static_cast<std::uint64_t>(n);
    }
}

void OutputFile::flush() {
    put(buffer_.data(), buffer_.size());
    buffer_.clear();
}

void OutputFile::write(const void* data, std::size_t bytes) {
    const char* from = static_cast<const char*>(data);
    if (buffer_.size() + bytes > bufferBytes) flush();
    if (bytes >= bufferBytes)
        put(from, bytes);
    else
        buffer_.append(from, bytes);
}

void OutputFile::patch(std::uint64_t position, const void* data, std::size_t bytes) {
    flush();
    const char* from = static_cast<const char*>(data);
    while (bytes > 0) {
        const ssize_t n = ::pwrite(descriptor_, from, bytes, static_cast<off_t>(position));
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) throwSystemError("write", path_, errno, written_, expected_);
        from += n;
        position += static_cast<std::uint64_t>(n);
        bytes -= static_cast<std::size_t>(n);
    }
}

void OutputFile::close() {
    flush();
    const int descriptor = descriptor_;
    descriptor_ = -1;
    // Network file systems report a full disk only here.
    if (::close(descriptor) != 0 && errno != EINTR)
        throwSystemError("write", path_, errno, written_, expected_);
}

void pipeBlocks(std::size_t count, const std::function<void(std::size_t, std::string&)>& make,
                const std::function<void(std::size_t, const std::string&)>& take, const Context& context) {
    BlockPool pool;
    std::size_t next = 0;
    const auto first =
        tbb::make_filter<void, Block*>(tbb::filter_mode::serial_in_order, [&](tbb::flow_control& flow) {
            context.checkCancelled();
            if (next == count) {
                flow.stop();
                return static_cast<Block*>(nullptr);
            }
            return pool.take(next++);
        });
    const auto second = tbb::make_filter<Block*, Block*>(tbb::filter_mode::parallel, [&](Block* block) {
        make(block->index, block->bytes);
        return block;
    });
    const auto third = tbb::make_filter<Block*, void>(tbb::filter_mode::serial_in_order, [&](Block* block) {
        take(block->index, block->bytes);
        pool.give(block);
    });
    const auto threads = static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
    tbb::parallel_pipeline(2 * threads + 1, first & second & third);
}

void writeBlocks(OutputFile& file, std::size_t n, std::size_t block,
                 const std::function<void(std::size_t, std::size_t, std::string&)>& format,
                 const Context& context) {
    pipeBlocks((n + block - 1) / block,
               [&](std::size_t i, std::string& out) { format(i * block, std::min(n, (i + 1) * block), out); },
               [&](std::size_t, const std::string& bytes) { file.write(bytes); }, context);
}

void writeRaw(OutputFile& file, std::span<const std::byte> bytes, const Context& context) {
    constexpr std::size_t piece = std::size_t(8) << 20;
    for (std::size_t begin = 0; begin < bytes.size(); begin += piece) {
        context.checkCancelled();
        file.write(bytes.data() + begin, std::min(piece, bytes.size() - begin));
    }
}

} // namespace i2b
