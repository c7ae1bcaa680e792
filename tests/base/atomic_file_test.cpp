#include "base/atomic_file.h"

#include "base/durable_file.h"
#include "support/expect_error.h"
#include "support/temporary_folder.h"

#include <fstream>
#include <sys/wait.h>
#include <unistd.h>

namespace quoin {
namespace {

namespace fs = std::filesystem;
using test::error_of;

std::size_t entries(const fs::path& folder)
{
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

TEST(AtomicFile, IsWrittenWholeAndLeavesNothingElse)
{
    const test::TemporaryFolder folder;
    write_atomically(folder.path() / "a.txt", std::string_view("one"));
    write_atomically(folder.path() / "a.txt", std::string_view("two"));
    EXPECT_EQ(read_text(folder.path() / "a.txt"), "two");
    EXPECT_EQ(entries(folder.path()), 1u);
}

TEST(AtomicFile, OldContentStaysWhenWritingFails)
{
    const test::TemporaryFolder folder;
    write_atomically(folder.path() / "a.txt", std::string_view("old"));
    const auto fail_halfway = [](const fs::path& temporary) {
        std::ofstream(temporary) << "half";
        throw InputError("stopped");
    };
    EXPECT_EQ(error_of([&] { write_atomically(folder.path() / "a.txt", fail_halfway); }, ExitCode::Input), "stopped");
    EXPECT_EQ(read_text(folder.path() / "a.txt"), "old");
    EXPECT_EQ(entries(folder.path()), 1u);
}

TEST(AtomicFile, MissingFolderIsNamed)
{
    const test::TemporaryFolder folder;
    const fs::path path = folder.path() / "no" / "a.txt";
    EXPECT_THAT(error_of([&] { write_atomically(path, std::string_view("x")); }, ExitCode::Input),
                testing::HasSubstr(path.string()));
}

TEST(AtomicFolder, ReplacesTheOldOneWhole)
{
    const test::TemporaryFolder folder;
    const fs::path model = folder.path() / "model";
    const auto fill_with = [](const char* name) {
        return [name](const fs::path& place) { std::ofstream(place / name) << "x"; };
    };
    write_folder_atomically(model, fill_with("old"));
    write_folder_atomically(model, fill_with("new"));
    EXPECT_FALSE(fs::exists(model / "old"));
    EXPECT_TRUE(fs::exists(model / "new"));
    EXPECT_EQ(entries(folder.path()), 1u);
}

TEST(UnfinishedFiles, AreRemovedOnRequest)
{
    const test::TemporaryFolder folder;
    const TemporaryPath temporary(folder.path() / "a.txt");
    std::ofstream(temporary.path()) << "half";
    remove_unfinished_files();
    EXPECT_EQ(entries(folder.path()), 0u);
}

TEST(ReadText, ReadsAnEmptyFileAndNamesAMissingOne)
{
    const test::TemporaryFolder folder;
    std::ofstream(folder.path() / "empty");
    EXPECT_EQ(read_text(folder.path() / "empty"), "");
    EXPECT_THAT(error_of([&] { read_text(folder.path() / "none"); }, ExitCode::Input), testing::HasSubstr("none"));
}

TEST(AbandonedFiles, AreThoseOfAProcessThatNobodyHasWaitedForToo)
{
    const test::TemporaryFolder folder;
    const pid_t child = ::fork();
    if (child == 0) {
        const TemporaryPath left(folder.path() / "result");
        std::ofstream(left.path()) << "half";
        ::_exit(0); // leaves it
    }
    siginfo_t info{};
    ASSERT_EQ(::waitid(P_PID, static_cast<id_t>(child), &info, WEXITED | WNOWAIT), 0);
    EXPECT_EQ(entries(folder.path()), 1u);
    EXPECT_EQ(remove_abandoned_files(folder.path()), 1u);
    EXPECT_EQ(entries(folder.path()), 0u);
    ::waitpid(child, nullptr, 0);
}

} // namespace
} // namespace quoin
