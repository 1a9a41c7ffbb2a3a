// Results appear under their final name complete or not at all. Everything is written into a hidden folder
// beside the target (or inside it, where the target is the root of a disk or its parent is not ours) and
// moved by rename at the end. If the target exists already only what was written is exchanged; other files in
// it are left alone.
//
//     AtomicFolder folder("case");
//     OutputFile file(folder.place("mesh.vtu"));   // ... write, close
//     folder.commit();                             // without it (an exception, a cancel) the target is as
//     before
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace i2b {

class AtomicFolder {
  public:
    // Throws Error{input} where the folder cannot be made.
    explicit AtomicFolder(const std::filesystem::path& target);
    ~AtomicFolder(); // removes whatever was not committed
    AtomicFolder(const AtomicFolder&) = delete;
    AtomicFolder& operator=(const AtomicFolder&) = delete;

    const std::filesystem::path& target() const { return target_; }
    const std::filesystem::path& staging() const { return staging_; }

    // Where to write the file that will be target/relative; its folders exist on return.
    std::filesystem::path place(const std::filesystem::path& relative);
    // Where to write the files of a folder that is exchanged as a whole: nothing of the old one survives.
    std::filesystem::path placeFolder(const std::filesystem::path& relative);
    // At commit removes target/relative, a file of an earlier run that would not fit the new result.
    void retire(const std::filesystem::path& relative);
    // Does the target hold it already?
    bool exists(const std::filesystem::path& relative) const;

    // Moves everything to the target. If one of the moves fails those done are undone and Error{input} is
    // thrown.
    void commit();

  private:
    struct Unit {
        std::filesystem::path relative;
        enum class Kind { file, folder, retired } kind;
    };
    // One move done, and how to undo it.
    struct Move {
        std::filesystem::path from, to;
        bool exchanged = false, createdFolder = false;
    };
    void merge();
    void moveUnit(const Unit& unit, std::size_t number, std::vector<Move>& done);
    void makeParents(const std::filesystem::path& place, std::vector<Move>& done);
    void makeStaging();
    void discard() noexcept;

    std::filesystem::path target_, staging_;
    std::vector<std::filesystem::path> createdParents_; // of the target, outermost first
    std::vector<Unit> units_;
    bool committed_ = false;
};

// The same for one file.
class AtomicFile {
  public:
    explicit AtomicFile(const std::filesystem::path& target);
    ~AtomicFile();
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;

    const std::filesystem::path& partial() const { return partial_; } // write here
    void commit();

  private:
    std::filesystem::path target_, partial_;
    bool committed_ = false;
};

// To be called before a long computation: can the result be written to this folder (existing or not), and is
// there room for about so many bytes? Leaves no trace. Throws Error{input}.
void checkWritable(const std::filesystem::path& folder, std::uint64_t expectedBytes = 0);

} // namespace i2b
