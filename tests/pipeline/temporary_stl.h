// A soup as a file, for as long as it lives.
#pragma once
#include "i2b/geometry/write_stl.h"
#include <filesystem>
#include <string>
#include <unistd.h>

namespace i2b::test {

class TemporaryStl {
  public:
    explicit TemporaryStl(const Surface& soup, unsigned number = 0)
        : path_(std::filesystem::temp_directory_path() /
                ("i2b_pipeline_" + std::to_string(getpid()) + "_" + std::to_string(number) + ".stl")) {
        writeStl(soup, path_.string(), StlFormat::ascii);
    }
    ~TemporaryStl() { std::filesystem::remove(path_); }
    TemporaryStl(const TemporaryStl&) = delete;
    TemporaryStl& operator=(const TemporaryStl&) = delete;
    std::string path() const { return path_.string(); }

  private:
    std::filesystem::path path_;
};

} // namespace i2b::test
