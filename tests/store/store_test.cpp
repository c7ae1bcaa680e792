#include "store/store.h"

#include "base/atomic_file.h"
#include "store/lease.h"
#include "store/manifest.h"
#include "support/expect_error.h"
#include "support/temporary_folder.h"

#include <atomic>
#include <csignal>
#include <ctime>
#include <fcntl.h>
#include <fstream>
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace quoin {
namespace {

namespace fs = std::filesystem;
using test::error_of;
using test::TemporaryFolder;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

KeyParts some_parts()
{
    return {"merge",
            "builtin/merge",
            1,
            {{"plane_mesh", "plane_mesh/1"}},
            {{"angle", 15.0}},
            {{"plane_mesh", {"plane_mesh/1", "aa"}}}};
}

// A store that holds one object under the key of some_parts().
void fill(const Store& store, const TemporaryFolder& folder, const std::string& text, const std::string& payload)
{
    write_atomically(folder / "object", text);
    const std::uint64_t size = store.adopt(folder / "object", payload);
    store.publish(make_key(some_parts()), {{{"plane_mesh", payload}}, "{}", {{"plane_mesh", size}}});
}

TEST(Key, DependsOnEverythingThatTheResultDependsOn)
{
    const std::string key = make_key(some_parts()).hex;
    auto changed = [&](auto change) {
        KeyParts parts = some_parts();
        change(parts);
        return make_key(parts).hex != key;
    };
    EXPECT_FALSE(changed([](KeyParts&) {}));
    EXPECT_TRUE(changed([](KeyParts& p) { p.params["angle"] = 16.0; }));
    EXPECT_TRUE(changed([](KeyParts& p) { p.impl_version = 2; }));
    EXPECT_TRUE(changed([](KeyParts& p) { p.inputs["plane_mesh"].payload = "bb"; }));
    EXPECT_TRUE(changed([](KeyParts& p) { p.stage = "other"; }));
}

TEST(Store, FindsWhatWasPublishedAndLinksIt)
{
    const TemporaryFolder folder;
    const Store store(folder / "store");
    EXPECT_FALSE(store.find(make_key(some_parts())).has_value());
    fill(store, folder, "hello", "1234");
    ASSERT_TRUE(store.find(make_key(some_parts())).has_value());
    store.link("1234", folder / "out/result");
    store.link("1234", folder / "out/result"); // again over itself
    EXPECT_EQ(read_text(folder / "out/result"), "hello");
    EXPECT_EQ(std::distance(fs::directory_iterator(folder / "out"), {}), 1);
}

TEST(Store, AnEntryWithoutItsObjectIsNoEntry)
{
    const TemporaryFolder folder;
    const Store store(folder / "store");
    fill(store, folder, "hello", "1234");
    fs::remove(store.object("1234"));
    EXPECT_FALSE(store.find(make_key(some_parts())).has_value());
    fill(store, folder, "hello", "1234");
    EXPECT_TRUE(store.find(make_key(some_parts())).has_value());
}

TEST(Store, ADamagedEntryIsComputedAgain)
{
    const TemporaryFolder folder;
    const Store store(folder / "store");
    fill(store, folder, "hello", "1234");
    for (const auto& entry : fs::recursive_directory_iterator(folder / "store/v1/ac"))
        if (entry.is_regular_file()) write_atomically(entry.path(), std::string_view("{"));
    EXPECT_FALSE(store.find(make_key(some_parts())).has_value());
    fill(store, folder, "hello", "1234");
    EXPECT_TRUE(store.find(make_key(some_parts())).has_value());
}

TEST(Store, TwoResultsOfOneKeyAreALoudError)
{
    const TemporaryFolder folder;
    const Store store(folder / "store");
    fill(store, folder, "hello", "1234");
    fill(store, folder, "hello", "1234");
    EXPECT_THAT(error_of([&] { fill(store, folder, "other", "5678"); }, ExitCode::Impossible),
                AllOf(HasSubstr("plane_mesh"), HasSubstr("not deterministic")));
}

TEST(Store, MovesWithEverythingInIt)
{
    const TemporaryFolder folder;
    fill(Store(folder / "store"), folder, "hello", "1234");
    fs::rename(folder / "store", folder / "moved");
    EXPECT_TRUE(Store(folder / "moved").find(make_key(some_parts())).has_value());
}

TEST(Store, HoldsFolders)
{
    const TemporaryFolder folder;
    const Store store(folder / "store");
    fs::create_directories(folder / "made/sub");
    write_atomically(folder / "made/sub/file", std::string_view("x"));
    store.adopt(folder / "made", "abcd");
    store.link("abcd", folder / "out/model");
    EXPECT_EQ(read_text(folder / "out/model/sub/file"), "x");
}

TEST(Store, ALeaseMakesTheSecondWait)
{
    const TemporaryFolder folder;
    const Store store(folder / "store");
    const Key key = make_key(some_parts());
    auto first = std::make_unique<Lease>(store, key, std::vector<std::string>{"needed"});
    EXPECT_THAT(lines_of(store.lease(key.hex)), ElementsAre("needed"));
    EXPECT_THAT(holder_text(store.lease(key.hex)), HasSubstr("process " + std::to_string(::getpid())));
    std::atomic<bool> released = false;
    std::thread second([&] {
        const Lease lease(store, key, {});
        EXPECT_TRUE(released);
    });
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    released = true;
    first.reset();
    second.join();
    EXPECT_FALSE(fs::exists(store.lease(key.hex)));
}

TEST(Store, ALeaseOfAKilledProcessHoldsNobodyUp)
{
    const TemporaryFolder folder;
    const Store store(folder / "store");
    const Key key = make_key(some_parts());
    const pid_t child = ::fork();
    if (child == 0) {
        const Lease lease(store, key, {});
        ::raise(SIGKILL);
    }
    ::waitpid(child, nullptr, 0);
    EXPECT_TRUE(fs::exists(store.lease(key.hex)));
    EXPECT_FALSE(is_held(store.lease(key.hex)));
    const auto begin = std::chrono::steady_clock::now();
    const Lease lease(store, key, {});
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(5)); // not until a heartbeat is stale
    EXPECT_TRUE(is_held(store.lease(key.hex)));
}

TEST(FolderDigest, FollowsContentAndNamesOnly)
{
    const TemporaryFolder folder;
    fs::create_directories(folder / "scan");
    write_atomically(folder / "scan/a", std::string_view("1"));
    const std::string digest = folder_digest(folder / "scan", folder / "cache");
    EXPECT_EQ(folder_digest(folder / "scan", folder / "cache"), digest);
    EXPECT_EQ(folder_digest(folder / "scan", {}), digest);
    write_atomically(folder / "scan/a", std::string_view("2"));
    EXPECT_NE(folder_digest(folder / "scan", folder / "cache"), digest);
    write_atomically(folder / "scan/a", std::string_view("1"));
    EXPECT_EQ(folder_digest(folder / "scan", folder / "cache"), digest);
    fs::rename(folder / "scan/a", folder / "scan/b");
    EXPECT_NE(folder_digest(folder / "scan", folder / "cache"), digest);
    EXPECT_EQ(folder_digest(folder / "scan/", folder / "cache"), folder_digest(folder / "scan", {})); // with a slash
    EXPECT_THAT(error_of([&] { folder_digest(folder / "none", {}); }, ExitCode::Input), HasSubstr("no such folder"));
}

TEST(FolderDigest, IsRememberedByStampsWhateverTheClockSays)
{
    const TemporaryFolder folder;
    fs::create_directories(folder / "scan/sub folder");
    const fs::path file = folder / "scan/sub folder/a b";
    const auto set_time = [&](std::time_t seconds) {
        const timespec times[] = {{seconds, 0}, {seconds, 0}};
        ::utimensat(AT_FDCWD, file.c_str(), times, 0);
    };
    write_atomically(file, std::string_view("1"));
    set_time(1'000'000'000);
    const std::string digest = folder_digest(folder / "scan", folder / "cache");
    // The clock is set back by years, and a file of the same size is written at a time before.
    write_atomically(file, std::string_view("2"));
    set_time(900'000'000);
    EXPECT_NE(folder_digest(folder / "scan", folder / "cache"), digest);
    // Its time is set to what it was: the inode and the time of that change are not.
    write_atomically(file, std::string_view("3"));
    set_time(1'000'000'000);
    EXPECT_EQ(folder_digest(folder / "scan", folder / "cache"), folder_digest(folder / "scan", {}));
}

TEST(FolderDigest, ADamagedStatCacheIsNotBelieved)
{
    const TemporaryFolder folder;
    fs::create_directories(folder / "scan");
    write_atomically(folder / "scan/a", std::string_view("1"));
    write_atomically(folder / "scan/b", std::string_view("2"));
    const std::string digest = folder_digest(folder / "scan", folder / "cache");
    const fs::path cache = fs::directory_iterator(folder / "cache")->path();
    const std::string text = read_text(cache);
    for (const std::string& damaged :
         {std::string("x"), text.substr(0, text.size() / 2), "-1 " + text, std::string()}) {
        std::ofstream(cache) << damaged;
        EXPECT_EQ(folder_digest(folder / "scan", folder / "cache"), digest);
    }
}

} // namespace
} // namespace quoin
