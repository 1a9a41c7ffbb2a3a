#include "i2b/write/atomic_folder.h"
#include "i2b/core/error.h"
#include "i2b/write/output_file.h"
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

namespace i2b {
namespace {

namespace fs = std::filesystem;

std::string partialName(const std::string& name) {
    static std::atomic<unsigned> serial{0};
    return fmt::format(".{}.partial-{}-{}", name, ::getpid(), serial++);
}

// An existing folder through links, a new one without "." and a trailing slash.
fs::path resolved(const fs::path& target) {
    if (target.empty()) throw Error(ErrorKind::usage, "the result has no name", "--out", "give a folder");
    std::error_code error;
    fs::path path = fs::weakly_canonical(fs::absolute(target), error);
    if (error) path = fs::absolute(target).lexically_normal();
    return path.has_filename() ? path : path.parent_path();
}

bool sameDevice(const fs::path& a, const fs::path& b) {
    struct stat left {
    }, right{};
    return ::stat(a.c_str(), &left) == 0 && ::stat(b.c_str(), &right) == 0 && left.st_dev == right.st_dev;
}

void requireAccess(const fs::path& folder) {
    if (::access(folder.c_str(), W_OK | X_OK) != 0) throwSystemError("write to the folder", folder, errno);
}

void makeFolder(const fs::path& folder) {
    if (::mkdir(folder.c_str(), 0777) != 0) throwSystemError("create the folder", folder, errno);
}

bool present(const fs::path& path) {
    std::error_code error;
    return fs::symlink_status(path, error).type() != fs::file_type::not_found;
}

// Swaps two names in one step; false where the file system cannot.
bool exchange(const fs::path& a, const fs::path& b) {
    return ::renameat2(AT_FDCWD, a.c_str(), AT_FDCWD, b.c_str(), RENAME_EXCHANGE) == 0;
}

void requireSameKind(const fs::path& place, bool folder) {
    if (!present(place) || fs::is_directory(place) == folder) return;
    throw Error(ErrorKind::input,
                folder ? "a file stands where a folder is to be written"
                       : "a folder stands where a file is to be written",
                place.string(), "move it away or choose another folder with --out");
}

} // namespace

AtomicFolder::AtomicFolder(const std::filesystem::path& target) : target_(resolved(target)) {
    if (present(target_) && !fs::is_directory(target_))
        throw Error(ErrorKind::input, "the result folder is a file", target_.string(),
                    "choose another folder with --out");
    try {
        makeStaging();
    } catch (...) {
        discard();
        throw;
    }
}

void AtomicFolder::makeStaging() {
    std::vector<fs::path> missing;
    for (fs::path parent = target_.parent_path(); !fs::is_directory(parent); parent = parent.parent_path()) {
        missing.push_back(parent);
        if (parent == parent.parent_path() || present(parent)) break; // a file in the way: mkdir will say so
    }
    for (auto parent = missing.rbegin(); parent != missing.rend(); ++parent) {
        makeFolder(*parent);
        createdParents_.push_back(*parent);
    }
    const std::string name = partialName(target_.filename().string());
    if (fs::is_directory(target_)) {
        requireAccess(target_);
        const fs::path beside = target_.parent_path();
        if (::access(beside.c_str(), W_OK | X_OK) != 0 || !sameDevice(beside, target_)) {
            makeFolder(target_ / name);
            staging_ = target_ / name;
            return;
        }
    }
    makeFolder(target_.parent_path() / name);
    staging_ = target_.parent_path() / name;
}

AtomicFolder::~AtomicFolder() { discard(); }

void AtomicFolder::discard() noexcept {
    std::error_code ignored;
    if (!staging_.empty()) fs::remove_all(staging_, ignored);
    staging_.clear();
    if (committed_) return;
    for (auto parent = createdParents_.rbegin(); parent != createdParents_.rend(); ++parent)
        fs::remove(*parent, ignored);
    createdParents_.clear();
}

std::filesystem::path AtomicFolder::place(const std::filesystem::path& relative) {
    const fs::path path = staging_ / relative;
    std::error_code error;
    fs::create_directories(path.parent_path(), error);
    if (error) throwSystemError("create the folder", path.parent_path(), error.value());
    units_.push_back({relative, Unit::Kind::file});
    return path;
}

std::filesystem::path AtomicFolder::placeFolder(const std::filesystem::path& relative) {
    const fs::path path = staging_ / relative;
    std::error_code error;
    fs::create_directories(path, error);
    if (error) throwSystemError("create the folder", path, error.value());
    units_.push_back({relative, Unit::Kind::folder});
    return path;
}

void AtomicFolder::retire(const std::filesystem::path& relative) {
    units_.push_back({relative, Unit::Kind::retired});
}

bool AtomicFolder::exists(const std::filesystem::path& relative) const { return present(target_ / relative); }

void AtomicFolder::commit() {
    if (present(target_) || ::rename(staging_.c_str(), target_.c_str()) != 0) {
        if (!present(target_)) throwSystemError("rename the result to", target_, errno);
        merge();
    }
    committed_ = true;
    discard(); // of the staging folder, which now holds what was replaced
}

void AtomicFolder::merge() {
    std::vector<Move> done;
    try {
        std::size_t number = 0;
        for (const Unit& unit : units_) moveUnit(unit, number++, done);
    } catch (...) {
        std::error_code ignored;
        for (auto move = done.rbegin(); move != done.rend(); ++move) {
            if (move->createdFolder)
                fs::remove(move->to, ignored);
            else if (move->exchanged)
                exchange(move->from, move->to);
            else
                fs::rename(move->to, move->from, ignored);
        }
        throw;
    }
}

void AtomicFolder::makeParents(const std::filesystem::path& place, std::vector<Move>& done) {
    std::vector<fs::path> missing;
    for (fs::path parent = place.parent_path(); parent != target_ && !present(parent);
         parent = parent.parent_path())
        missing.push_back(parent);
    for (auto parent = missing.rbegin(); parent != missing.rend(); ++parent) {
        makeFolder(*parent);
        done.push_back({{}, *parent, false, true});
    }
}

void AtomicFolder::moveUnit(const Unit& unit, std::size_t number, std::vector<Move>& done) {
    const fs::path from = staging_ / unit.relative, to = target_ / unit.relative;
    const auto move = [&](const fs::path& a, const fs::path& b) {
        if (::rename(a.c_str(), b.c_str()) != 0) throwSystemError("move the result to", b, errno);
        done.push_back({a, b});
    };
    const fs::path aside = staging_ / fmt::format(".replaced-{}", number);
    if (unit.kind == Unit::Kind::retired) {
        requireSameKind(to, false);
        if (present(to)) move(to, aside);
        return;
    }
    if (!present(from)) return; // announced, but never written
    requireSameKind(to, unit.kind == Unit::Kind::folder);
    makeParents(to, done);
    if (!present(to)) return move(from, to);
    if (exchange(from, to)) {
        done.push_back({from, to, true});
        return;
    }
    move(to, aside);
    move(from, to);
}

AtomicFile::AtomicFile(const std::filesystem::path& target) : target_(resolved(target)) {
    requireSameKind(target_, false);
    const fs::path parent = target_.parent_path();
    if (!fs::is_directory(parent))
        throw Error(ErrorKind::input, "the folder of the result does not exist", parent.string(),
                    "create it first");
    requireAccess(parent);
    partial_ = parent / partialName(target_.filename().string());
}

AtomicFile::~AtomicFile() {
    std::error_code ignored;
    if (!committed_) fs::remove(partial_, ignored);
}

void AtomicFile::commit() {
    if (::rename(partial_.c_str(), target_.c_str()) != 0)
        throwSystemError("rename the result to", target_, errno);
    committed_ = true;
}

void checkWritable(const std::filesystem::path& folder, std::uint64_t expectedBytes) {
    AtomicFolder probe(folder);
    OutputFile file(probe.place("probe"), expectedBytes);
    file.write("probe");
    file.close();
    for (const char* part : {"constant", "system"}) {
        requireSameKind(probe.target() / part, true);
        if (probe.exists(part)) requireAccess(probe.target() / part);
    }
}

} // namespace i2b
