#include "i2b/core/error.h"
#include "i2b/write/atomic_folder.h"
#include "i2b/write/foam_write.h"
#include "i2b/write/output_file.h"
#include "write/mesh_samples.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <set>

namespace i2b {
namespace {

namespace fs = std::filesystem;
using test::contents, test::put, test::TempFolder;

// Every path under a folder, with the content of files.
std::set<std::string> listing(const fs::path& folder) {
    std::set<std::string> all;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        all.insert(fs::relative(entry.path(), folder).string() +
                   (entry.is_regular_file() ? "=" + contents(entry.path()) : "/"));
    return all;
}

void write(const fs::path& path, const std::string& text) {
    OutputFile file(path);
    file.write(text);
    file.close();
}

// A new result shows under its name, and nothing else is left beside it.
TEST(AtomicFolder, NewResultAppearsAtCommit) {
    const TempFolder temp;
    {
        AtomicFolder folder(temp / "a/b/case");
        write(folder.place("sub/file"), "new");
        EXPECT_FALSE(fs::exists(temp / "a/b/case"));
        folder.commit();
    }
    EXPECT_THAT(listing(temp.path()),
                testing::ElementsAre("a/", "a/b/", "a/b/case/", "a/b/case/sub/", "a/b/case/sub/file=new"));
}

// An exception before commit leaves no trace: not the folder, not its parents, not the partial files.
TEST(AtomicFolder, ExceptionLeavesNothing) {
    const TempFolder temp;
    try {
        AtomicFolder folder(temp / "a/b/case");
        write(folder.place("file"), "half");
        throw std::runtime_error("in the middle");
    } catch (const std::runtime_error&) {
    }
    EXPECT_TRUE(listing(temp.path()).empty());
}

// In an existing result only what was written is exchanged; a folder unit loses its old content, the user's
// files stay.
TEST(AtomicFolder, ExistingResultIsMerged) {
    const TempFolder temp;
    put(temp / "case/constant/polyMesh/stale", "old");
    put(temp / "case/constant/user", "mine");
    put(temp / "case/0/U", "mine");
    put(temp / "case/mesh.vtu", "old");
    put(temp / "case/wall.ply", "old");
    AtomicFolder folder(temp / "case");
    write(folder.placeFolder("constant/polyMesh") / "points", "new");
    write(folder.place("mesh.vtu"), "new");
    write(folder.place("system/controlDict"), "new");
    folder.retire("wall.ply");
    folder.commit();
    EXPECT_THAT(listing(temp.path()),
                testing::UnorderedElementsAre("case/", "case/0/", "case/0/U=mine", "case/constant/",
                                              "case/constant/user=mine", "case/constant/polyMesh/",
                                              "case/constant/polyMesh/points=new", "case/mesh.vtu=new",
                                              "case/system/", "case/system/controlDict=new"));
}

// A move that fails halfway through commit (a file stands where a folder must come) takes back those before
// it.
TEST(AtomicFolder, FailedCommitKeepsTheOldResult) {
    const TempFolder temp;
    put(temp / "case/constant/polyMesh/points", "old");
    put(temp / "case/gone", "old");
    put(temp / "case/system", "a file");
    const auto before = listing(temp.path());
    try {
        AtomicFolder folder(temp / "case");
        write(folder.placeFolder("constant/polyMesh") / "points", "new");
        write(folder.place("added/file"), "new");
        folder.retire("gone");
        write(folder.place("system/controlDict"), "new");
        folder.commit();
        FAIL() << "commit must not succeed";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input);
        EXPECT_THAT(error.what(), testing::HasSubstr("system"));
    }
    EXPECT_EQ(listing(temp.path()), before);
}

// A writer stopped in the middle, by a cancel or by a full disk, leaves the old mesh as it was.
TEST(AtomicFolder, CancelledWriterKeepsTheOldMesh) {
    const TempFolder temp;
    put(temp / "case/constant/polyMesh/points", "old");
    const auto before = listing(temp.path());
    Context context;
    context.cancel();
    const PolyMesh mesh = test::boxMesh({3, 3, 3});
    const auto attempt = [&] {
        AtomicFolder folder(temp / "case");
        writeFoam(mesh, folder, {}, context);
        folder.commit();
    };
    EXPECT_THROW(attempt(), Cancelled);
    EXPECT_EQ(listing(temp.path()), before);
}

// A place that cannot be written is refused before any work, with a sentence that names it; root or not.
TEST(CheckWritable, RefusesPlacesThatCannotBe) {
    const TempFolder temp;
    put(temp / "file", "x");
    for (const fs::path& bad : {temp / "file", temp / "file/case", fs::path("/proc/i2b-case")}) {
        try {
            checkWritable(bad);
            ADD_FAILURE() << bad << " was accepted";
        } catch (const Error& error) {
            EXPECT_EQ(error.exitStatus(), 1);
            EXPECT_THAT(error.what(), testing::HasSubstr(temp.path().string().substr(0, 1)));
            EXPECT_FALSE(error.remedy().empty());
        }
    }
    EXPECT_THAT(listing(temp.path()), testing::ElementsAre("file=x"));
}

// A folder without write permission; root may write anywhere, so it is tested for others only.
TEST(CheckWritable, RefusesFolderWithoutPermission) {
    if (::geteuid() == 0) GTEST_SKIP() << "root may write to any folder";
    const TempFolder temp;
    fs::permissions(temp.path(), fs::perms::owner_read | fs::perms::owner_exec);
    EXPECT_THROW(checkWritable(temp / "case"), Error);
    fs::permissions(temp.path(), fs::perms::owner_all);
}

// A good place passes and is left as it was, whether it exists or not.
TEST(CheckWritable, AcceptsAndLeavesNoTrace) {
    const TempFolder temp;
    put(temp / "case/0/U", "mine");
    const auto before = listing(temp.path());
    checkWritable(temp / "case");
    checkWritable(temp / "not/yet/there", 1000);
    EXPECT_EQ(listing(temp.path()), before);
}

// More than the disk holds is refused at once, and the sentence says how much is needed and how much there
// is.
TEST(CheckWritable, SaysHowMuchRoomIsMissing) {
    const TempFolder temp;
    try {
        checkWritable(temp / "case", std::uint64_t(3) << 60);
        FAIL() << "3 EB were accepted";
    } catch (const Error& error) {
        EXPECT_THAT(error.what(),
                    testing::AllOf(testing::HasSubstr("disk is full"), testing::HasSubstr("3.46 EB"),
                                   testing::HasSubstr("are free")));
    }
}

// A disk that fills up while writing (/dev/full) is an input error that says how far it got.
TEST(OutputFile, FullDiskIsAnInputError) {
    if (!fs::exists("/dev/full")) GTEST_SKIP() << "this system has no /dev/full";
    try {
        OutputFile file("/dev/full");
        file.write(std::string(3 << 20, 'x'));
        file.close();
        FAIL() << "/dev/full took data";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input);
        EXPECT_THAT(error.what(), testing::HasSubstr("disk is full: 0 B of this file are written"));
    }
}

// Blocks come out in order and patches land where they should, below and above the buffer's size.
TEST(OutputFile, BlocksInOrderAndPatches) {
    const TempFolder temp;
    std::string expected = "head....";
    {
        OutputFile file(temp / "f");
        file.write("head....");
        const auto format = [](std::size_t begin, std::size_t end, std::string& out) {
            for (std::size_t i = begin; i < end; ++i) out += std::to_string(i) + "\n";
        };
        writeBlocks(file, 300001, 1000, format, Context());
        file.patch(4, "!!!!", 4);
        file.close();
    }
    expected = "head!!!!";
    for (int i = 0; i < 300001; ++i) expected += std::to_string(i) + "\n";
    EXPECT_EQ(contents(temp / "f"), expected);
}

// One file: replaced at commit, untouched without it.
TEST(AtomicFile, ReplacesAtCommitOnly) {
    const TempFolder temp;
    put(temp / "f", "old");
    {
        AtomicFile file(temp / "f");
        write(file.partial(), "half");
    }
    EXPECT_THAT(listing(temp.path()), testing::ElementsAre("f=old"));
    AtomicFile file(temp / "f");
    write(file.partial(), "new");
    file.commit();
    EXPECT_THAT(listing(temp.path()), testing::ElementsAre("f=new"));
}

} // namespace
} // namespace i2b
