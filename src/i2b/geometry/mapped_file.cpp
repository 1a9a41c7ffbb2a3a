#include "i2b/geometry/mapped_file.h"
#include "i2b/core/error.h"
#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <libdeflate.h>
#include <new>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

namespace i2b {
namespace {

[[noreturn]] void refuse(const std::string& path, std::string what, std::string remedy) {
    throw Error(ErrorKind::input, std::move(what), path, std::move(remedy));
}

[[noreturn]] void refuseErrno(const std::string& path, int error) {
    if (error == ENOENT || error == ENOTDIR)
        refuse(path, "the geometry file does not exist", "check the path");
    if (error == EACCES || error == EPERM)
        refuse(path, "the geometry file may not be read", "check its permissions");
    refuse(path, fmt::format("the geometry file cannot be read, {}", std::strerror(error)), "check the disk");
}

struct Descriptor {
    int fd;
    ~Descriptor() {
        if (fd >= 0) ::close(fd);
    }
};

bool isGzip(std::string_view bytes) {
    return bytes.size() >= 3 && bytes[0] == '\x1f' && bytes[1] == '\x8b' && bytes[2] == '\x08';
}

// The trailer's size of the last member, modulo 2^32: a hint only. Deflate packs at most 1032 to 1.
std::size_t sizeHint(std::string_view gz) {
    if (gz.size() < 18) return 0;
    std::size_t size = 0;
    for (std::size_t i = 0; i < 4; ++i)
        size |= std::size_t(static_cast<unsigned char>(gz[gz.size() - 4 + i])) << (8 * i);
    return size <= 1032 * gz.size() ? size : 0;
}

struct Inflater {
    z_stream stream{};
    Inflater() {
        if (inflateInit2(&stream, 15 + 16) != Z_OK) throw std::bad_alloc();
    }
    ~Inflater() { inflateEnd(&stream); }
};

// What is wrong with a compressed file and where, which zlib tells.
[[noreturn]] void refuseDamaged(const std::string& path, std::string_view gz) {
    Inflater inflater;
    z_stream& z = inflater.stream;
    constexpr std::size_t most = std::size_t{1} << 30; // zlib counts in 32 bits
    std::array<Bytef, 1 << 16> scratch;
    std::size_t read = 0;
    for (;;) {
        const std::size_t in = std::min(most, gz.size() - read);
        z.next_in = const_cast<Bytef*>(reinterpret_cast<const Bytef*>(gz.data() + read));
        z.avail_in = static_cast<uInt>(in);
        z.next_out = scratch.data();
        z.avail_out = static_cast<uInt>(scratch.size());
        const int status = ::inflate(&z, Z_NO_FLUSH);
        read += in - z.avail_in;
        if (status == Z_MEM_ERROR) throw std::bad_alloc();
        if (status == Z_STREAM_END && isGzip(gz.substr(read))) inflateReset(&z);
        else if (status == Z_BUF_ERROR && z.avail_out != 0) // room to write, nothing left to read
            refuse(path, fmt::format("the compressed file is truncated: its {} bytes end early", gz.size()), "copy it again");
        else if (status != Z_OK && status != Z_BUF_ERROR) refuse(path, fmt::format("the compressed file is damaged near byte {}", read), "copy it again");
    }
}

} // namespace

void MappedFile::Free::operator()(char* p) const { std::free(p); }

MappedFile::MappedFile(const std::string& path) : path_(path) {
    const Descriptor file{::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)};
    if (file.fd < 0) refuseErrno(path, errno);
    struct stat info {};
    if (::fstat(file.fd, &info) != 0) refuseErrno(path, errno);
    if (S_ISDIR(info.st_mode)) refuse(path, "the geometry is a folder, not a file", "name the files in it");
    if (!S_ISREG(info.st_mode)) refuse(path, "the geometry is not a regular file", "save it as a file first");
    if (info.st_size == 0) refuse(path, "the geometry file is empty", "export it again");
    mapSize_ = static_cast<std::size_t>(info.st_size);
    void* const map = ::mmap(nullptr, mapSize_, PROT_READ, MAP_PRIVATE, file.fd, 0);
    if (map == MAP_FAILED) refuseErrno(path, errno);
    map_ = map;
    bytes_ = {static_cast<const char*>(map_), mapSize_};
    ::madvise(map_, mapSize_, MADV_WILLNEED);
    if (isGzip(bytes_)) {
        try {
            inflate();
        } catch (...) { // the destructor does not run for a half-made object
            ::munmap(map_, mapSize_);
            throw;
        }
    }
}

MappedFile::~MappedFile() {
    if (map_) ::munmap(map_, mapSize_);
}

void MappedFile::inflate() {
    const std::unique_ptr<libdeflate_decompressor, decltype(&libdeflate_free_decompressor)> decompressor(libdeflate_alloc_decompressor(), &libdeflate_free_decompressor);
    if (!decompressor) throw std::bad_alloc();
    std::size_t room = 0, size = 0;
    const auto makeRoom = [&](std::size_t wanted) {
        char* const grown = static_cast<char*>(std::realloc(inflated_.get(), wanted));
        if (!grown) throw std::bad_alloc();
        static_cast<void>(inflated_.release()); // realloc has freed it
        inflated_.reset(grown);
        room = wanted;
    };
    makeRoom(std::max<std::size_t>(sizeHint(bytes_), 4 * bytes_.size()) + 64);
    for (std::string_view gz = bytes_; isGzip(gz);) { // member after member; padding after the last one is allowed
        std::size_t in = 0, made = 0;
        const libdeflate_result result = libdeflate_gzip_decompress_ex(decompressor.get(), gz.data(), gz.size(), inflated_.get() + size, room - size, &in, &made);
        if (result == LIBDEFLATE_INSUFFICIENT_SPACE) {
            makeRoom(2 * room); // for the same one again
            continue;
        }
        if (result != LIBDEFLATE_SUCCESS) refuseDamaged(path_, bytes_);
        size += made;
        gz.remove_prefix(in);
    }
    if (size == 0) refuse(path_, "the compressed file holds nothing", "export it again");
    bytes_ = {inflated_.get(), size};
    ::munmap(map_, mapSize_);
    map_ = nullptr;
}

void MappedFile::release(std::size_t begin, std::size_t end) const {
    if (!map_) return;
    const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
    begin = (begin + page - 1) / page * page;
    end = end == mapSize_ ? (end + page - 1) / page * page : end / page * page;
    if (begin < end) ::madvise(static_cast<char*>(map_) + begin, end - begin, MADV_DONTNEED);
}

} // namespace i2b
