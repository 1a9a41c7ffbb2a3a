#include "i2b/write/vdb_file.h"
#include "i2b/core/checksum.h"
#include "i2b/core/error.h"
#include "i2b/write/output_file.h"
#include <cerrno>
#include <fmt/format.h>
#include <openvdb/io/Archive.h>

namespace i2b {
namespace {

// The library's own File does not look whether its stream failed: a full disk would pass for success.
class StreamArchive : public openvdb::io::Archive {
  public:
    StreamArchive() { setCompression(openvdb::io::COMPRESS_BLOSC | openvdb::io::COMPRESS_ACTIVE_MASK); }
    // Through a stream of its own each time: the library leaves pointers to its settings in the stream.
    void put(std::fstream& file, const openvdb::GridCPtrVec& grids, const openvdb::MetaMap& meta) const {
        std::ostream out(file.rdbuf());
        out.exceptions(std::ios::failbit | std::ios::badbit);
        write(out, grids, true, meta);
        out.flush();
    }

  private:
    using Archive::write;
};

// The library draws a random UUID; ours says what the file holds. It stands behind the magic number, three
// versions and a flag.
void settleUuid(const std::filesystem::path& path) {
    constexpr std::streamoff place = 8 + 3 * 4 + 1;
    constexpr std::size_t length = 36;
    std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
    std::string text(length, ' ');
    file.seekg(place);
    file.read(text.data(), length);
    if (!file || text[8] != '-' || text[23] != '-') return; // a later layout: leave it
    Checksum sum;
    std::vector<char> buffer(std::size_t(1) << 20);
    while (file.read(buffer.data(), static_cast<std::streamsize>(buffer.size())), file.gcount() > 0)
        sum.bytes(buffer.data(), static_cast<std::size_t>(file.gcount()));
    file.clear();
    const std::string a = sum.hex();
    sum.add(std::uint64_t(1));
    const std::string b = sum.hex();
    text = fmt::format("{}-{}-4{}-8{}-{}", a.substr(0, 8), a.substr(8, 4), a.substr(13, 3), b.substr(1, 3),
                       b.substr(4, 12));
    file.seekp(place);
    file.write(text.data(), length);
    file.close();
    if (!file) throwSystemError("write", path, errno ? errno : EIO);
}

} // namespace

// Runs what writes; whatever goes wrong is an Error.
template <class Body>
void VdbFile::guarded(const Body& body) {
    errno = 0;
    try {
        body();
    } catch (const std::ios::failure&) {
        throwSystemError("write", path_, errno ? errno : EIO);
    } catch (const openvdb::Exception& problem) {
        if (!file_ || errno == ENOSPC) throwSystemError("write", path_, errno ? errno : EIO);
        throw Error(ErrorKind::internal, problem.what(), path_.string(), "report this");
    }
}

VdbFile::VdbFile(std::filesystem::path path, const openvdb::MetaMap& meta) : path_(std::move(path)), meta_(meta) {
    errno = 0;
    file_.open(path_, std::ios::binary | std::ios::in | std::ios::out | std::ios::trunc);
    if (!file_) throwSystemError("create the file", path_, errno);
    guarded([&] {
        file_.exceptions(std::ios::failbit | std::ios::badbit);
        StreamArchive().put(file_, {}, meta_);
        head_ = file_.tellp();
    });
}

// A grid's bytes know their places in the file, but not each other. So each is written as a file of its own whose head
// lies over the last bytes of what is there, which then go back.
void VdbFile::add(const openvdb::GridBase& grid) {
    guarded([&] {
        file_.seekp(0, std::ios::end);
        const std::streamoff start = file_.tellp() - head_;
        std::string under(static_cast<std::size_t>(head_), ' ');
        file_.seekg(start);
        file_.read(under.data(), head_);
        file_.seekp(start);
        StreamArchive().put(file_, {openvdb::ConstPtrCast<const openvdb::GridBase>(grid.copyGrid())}, meta_);
        file_.seekp(start);
        file_.write(under.data(), head_);
        ++grids_;
    });
}

void VdbFile::close() {
    guarded([&] {
        file_.seekp(head_ - static_cast<std::streamoff>(sizeof grids_)); // the head ends with their number
        file_.write(reinterpret_cast<const char*>(&grids_), sizeof grids_);
        file_.close();
    });
    settleUuid(path_);
}

} // namespace i2b
