#include "i2b/geometry/mapped_file.h"
#include "i2b/core/error.h"
#include <algorithm>
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

// All members of a compressed file, into so much room. Gives the size; 0: too little room, or something is wrong, which
// zlib tells better.
std::size_t inflateAll(std::string_view gz, char* out, std::size_t room) {
    const std::unique_ptr<libdeflate_decompressor, decltype(&libdeflate_free_decompressor)> decompressor(libdeflate_alloc_decompressor(), &libdeflate_free_decompressor);
    if (!decompressor) throw std::bad_alloc();
    std::size_t size = 0;
    while (isGzip(gz)) { // padding after the last member is allowed
        std::size_t in = 0, made = 0;
        if (libdeflate_gzip_decompress_ex(decompressor.get(), gz.data(), gz.size(), out + size, room - size, &in, &made) != LIBDEFLATE_SUCCESS) return 0;
        size += made;
        gz.remove_prefix(in);
    }
    return size;
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
    const std::size_t room = std::max<std::size_t>(sizeHint(bytes_), 4 * bytes_.size()) + 64;
    inflated_.reset(static_cast<char*>(std::malloc(room)));
    if (!inflated_) throw std::bad_alloc();
    std::size_t size = inflateAll(bytes_, inflated_.get(), room);
    if (size == 0) size = inflateStepwise(room);
    bytes_ = {inflated_.get(), size};
    ::munmap(map_, mapSize_);
    map_ = nullptr;
}

std::size_t MappedFile::inflateStepwise(std::size_t capacity) {
    const std::string_view gz = bytes_;
    std::size_t size = 0, read = 0;
    Inflater inflater;
    z_stream& z = inflater.stream;
    constexpr std::size_t most = std::size_t{1} << 30; // zlib counts in 32 bits
    for (;;) {
        if (size == capacity) {
            capacity += capacity / 2;
            char* const grown = static_cast<char*>(std::realloc(inflated_.get(), capacity));
            if (!grown) throw std::bad_alloc();
            static_cast<void>(inflated_.release()); // realloc has freed it
            inflated_.reset(grown);
        }
        const std::size_t in = std::min(most, gz.size() - read), out = std::min(most, capacity - size);
        z.next_in = const_cast<Bytef*>(reinterpret_cast<const Bytef*>(gz.data() + read));
        z.avail_in = static_cast<uInt>(in);
        z.next_out = reinterpret_cast<Bytef*>(inflated_.get() + size);
        z.avail_out = static_cast<uInt>(out);
        const int status = ::inflate(&z, Z_NO_FLUSH);
        read += in - z.avail_in;
        size += out - z.avail_out;
        if (status == Z_STREAM_END) {
            if (!isGzip(gz.substr(read))) break; // padding after the last member is allowed
            inflateReset(&z);
        } else if (status == Z_MEM_ERROR) {
            throw std::bad_alloc();
        } else if (status == Z_BUF_ERROR && z.avail_out != 0) { // room to write, nothing left to read
            refuse(path_, fmt::format("the compressed file is truncated: its {} bytes end early", gz.size()),
                   "copy it again");
        } else if (status != Z_OK && status != Z_BUF_ERROR) {
            refuse(path_, fmt::format("the compressed file is damaged near byte {}", read), "copy it again");
        }
    }
    if (size == 0) refuse(path_, "the compressed file holds nothing", "export it again");
    return size;
}

void MappedFile::release(std::size_t begin, std::size_t end) const {
    if (!map_) return;
    const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
    begin = (begin + page - 1) / page * page;
    end = end == mapSize_ ? (end + page - 1) / page * page : end / page * page;
    if (begin < end) ::madvise(static_cast<char*>(map_) + begin, end - begin, MADV_DONTNEED);
}

} // namespace i2b
