// A .vdb file that takes its grids one at a time, where the library wants all of them in memory at once.
#pragma once
#include "i2b/grid/vdb.h"
#include <filesystem>
#include <fstream>

namespace i2b {

class VdbFile {
  public:
    // Creates or truncates the file. Throws Error{input}, as all members do.
    VdbFile(std::filesystem::path path, const openvdb::MetaMap& meta);
    // Names must differ.
    void add(const openvdb::GridBase& grid);
    // The file is complete only then. Gives it a UUID that comes from what is in it.
    void close();

  private:
    template <class Body>
    void guarded(const Body& body);
    std::filesystem::path path_;
    const openvdb::MetaMap meta_;
    std::fstream file_;
    std::streamoff head_ = 0; // bytes before the first grid
    std::int32_t grids_ = 0;
};

} // namespace i2b
