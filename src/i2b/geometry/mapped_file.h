// The bytes of a file: memory-mapped where it is plain, inflated into memory where it is gzip (told by its
// magic bytes, whatever its name). Read-only; any number of threads may read.
#pragma once
#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

namespace i2b {

class MappedFile {
  public:
    // Throws Error (input): missing, unreadable, a folder, empty, damaged or truncated gzip.
    explicit MappedFile(const std::string& path);
    ~MappedFile();
    MappedFile(const MappedFile&) = delete;
    MappedFile& operator=(const MappedFile&) = delete;

    std::string_view bytes() const { return bytes_; }
    const std::string& path() const { return path_; }

    // The stretch has been read and is not needed soon: lets the system take its pages back, so that a large
    // file does not count in the resident size. It may still be read again.
    void release(std::size_t begin, std::size_t end) const;

  private:
    void inflate();

    struct Free {
        void operator()(char* p) const;
    };
    std::string path_;
    void* map_ = nullptr;
    std::size_t mapSize_ = 0;
    std::unique_ptr<char, Free> inflated_; // malloc'ed, so that it can grow without a copy
    std::string_view bytes_;
};

} // namespace i2b
