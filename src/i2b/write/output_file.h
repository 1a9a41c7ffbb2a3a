// A file written once from front to back, and a pipeline that prepares its blocks in parallel and writes them
// in order: the bytes never depend on the number of threads. Every failure of the system becomes an
// Error{input} that says what could not be written and how much room there is.
#pragma once
#include "i2b/core/context.h"
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>

namespace i2b {

class OutputFile {
  public:
    // Creates or truncates the file. expectedBytes > 0: refuses at once where the disk has less room.
    explicit OutputFile(std::filesystem::path path, std::uint64_t expectedBytes = 0);
    ~OutputFile(); // closes silently; call close() to learn of late errors
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;

    void write(const void* data, std::size_t bytes);
    void write(std::string_view text) { write(text.data(), text.size()); }
    // Overwrites bytes written earlier: tables whose content is known only after what they describe.
    void patch(std::uint64_t position, const void* data, std::size_t bytes);
    void close();

    std::uint64_t size() const { return written_ + buffer_.size(); }
    const std::filesystem::path& path() const { return path_; }

  private:
    void flush();
    void put(const char* data, std::size_t bytes);
    std::filesystem::path path_;
    std::string buffer_;
    std::uint64_t written_ = 0, expected_ = 0;
    int descriptor_ = -1;
};

// make(i, out) fills the empty buffer `out` for each i of [0, count) on any thread; take(i, block) gets them
// one at a time in order. Few blocks are alive at once. Throws Cancelled between blocks.
void pipeBlocks(std::size_t count, const std::function<void(std::size_t, std::string&)>& make,
                const std::function<void(std::size_t, const std::string&)>& take, const Context& context);

// Writes format(begin, end, out) of consecutive ranges of at most `block` items of [0, n).
void writeBlocks(OutputFile& file, std::size_t n, std::size_t block,
                 const std::function<void(std::size_t, std::size_t, std::string&)>& format,
                 const Context& context);

// Writes memory as it is, in pieces, so that a cancel is heard.
void writeRaw(OutputFile& file, std::span<const std::byte> bytes, const Context& context);

template <class T>
void writeArray(OutputFile& file, std::span<const T> values, const Context& context) {
    writeRaw(file, std::as_bytes(values), context);
}

// The Error for a failed system call on a path: `doing` is a verb phrase ("write", "create the folder").
[[noreturn]] void throwSystemError(const std::string& doing, const std::filesystem::path& path, int error,
                                   std::uint64_t written = 0, std::uint64_t expected = 0);

// Room for an ordinary user on the disk that holds the path (or its nearest existing ancestor), bytes.
std::uint64_t freeBytes(const std::filesystem::path& path);

std::string humanBytes(std::uint64_t bytes); // "1.5 GB", powers of ten

} // namespace i2b
