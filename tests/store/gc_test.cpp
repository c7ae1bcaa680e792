#include "store/gc.h"

#include "artifact/artifact.h"
#include "base/atomic_file.h"
#include "store/lease.h"
#include "store/pins.h"
#include "store/run_file.h"
#include "store/verify.h"
#include "support/temporary_folder.h"

#include <algorithm>
#include <ctime>
#include <fcntl.h>
#include <fstream>
#include <gmock/gmock.h>
#include <sys/stat.h>

namespace quoin {
namespace {

namespace fs = std::filesystem;
using test::TemporaryFolder;
using testing::HasSubstr;
using testing::SizeIs;

constexpr std::int64_t kDay = 86'400; // [s]

// A store with one result a number, each of some hundred bytes, all under keys of their own.
class StoreWithResults : public testing::Test {
protected:
    Key key(int number) const
    {
        return make_key({"toy", "builtin/toy", 1, {{"mesh", "mesh/1"}}, {{"number", std::int64_t{number}}}, {}});
    }

    std::string add(int number)
    {
        Artifact artifact{"mesh", 1, {}, {}};
        artifact.add<double>("number", {1}, std::vector<double>{static_cast<double>(number)});
        const TemporaryPath temporary(store_.temporary_place("mesh"));
        write_artifact(temporary.path(), artifact);
        const std::string payload = artifact.payload();
        const auto size = store_.adopt(temporary.path(), payload);
        store_.publish(key(number), {{{"mesh", payload}}, "{}", {{"mesh", size}}});
        return payload;
    }

    void was_used_days_ago(int number, int days)
    {
        const timespec then{std::time(nullptr) - days * kDay, 0};
        const timespec times[] = {then, then};
        ASSERT_EQ(::utimensat(AT_FDCWD, store_.entry(key(number).hex).c_str(), times, 0), 0);
    }

    bool has(int number) const { return store_.find(key(number)).has_value(); }

    // Changes one byte of a read-only object, as a failing disk would.
    void damage(const std::string& payload, std::streamoff from_end)
    {
        fs::permissions(store_.object(payload), fs::perms::owner_all);
        std::fstream file(store_.object(payload), std::ios::binary | std::ios::in | std::ios::out);
        file.seekg(-from_end, std::ios::end);
        const char byte = static_cast<char>(file.peek() ^ 1);
        file.seekp(-from_end, std::ios::end);
        file.put(byte);
    }

    TemporaryFolder folder_;
    Store store_{folder_ / "store"};
};

TEST_F(StoreWithResults, WithoutALimitOnlyRubbishIsCollected)
{
    add(1);
    const std::string orphan = add(2);
    fs::remove(store_.entry(key(2).hex));
    write_atomically(store_.root() / "tmp/.mesh.nowhere.1.abcd.tmp",
                     std::string_view("of another host: not known to be gone"));
    std::ofstream(store_.lease(key(1).hex)) << "{\"host\":\"gone\",\"pid\":1}\n";
    const GcReport report = collect_garbage(store_, {});
    EXPECT_THAT(report.removed, SizeIs(2));
    EXPECT_FALSE(fs::exists(store_.object(orphan)));
    EXPECT_TRUE(fs::is_empty(store_.root() / "lease"));
    EXPECT_TRUE(has(1));
    EXPECT_LT(report.size_after, report.size_before);
}

TEST_F(StoreWithResults, WhatWasUnusedForLongestGoesFirst)
{
    for (const int number : {1, 2, 3}) {
        add(number);
        was_used_days_ago(number, 10 * number);
    }
    const std::uint64_t size = store_.find(key(1))->sizes.at("mesh");
    was_used_days_ago(1, 10); // finding it marked it as used
    GcOptions options{.max_size = 2 * size, .older_than = {}, .keep_last = {}, .is_dry = true};
    EXPECT_THAT(collect_garbage(store_, options).removed, SizeIs(2)); // an entry and its object
    EXPECT_TRUE(fs::exists(store_.entry(key(3).hex)));
    options.is_dry = false;
    collect_garbage(store_, options);
    EXPECT_FALSE(has(3));
    EXPECT_TRUE(has(2));
    was_used_days_ago(2, 20);
    was_used_days_ago(1, 10);
    options = {.max_size = {}, .older_than = 15.0 * kDay, .keep_last = {}, .is_dry = false};
    collect_garbage(store_, options);
    EXPECT_FALSE(has(2));
    EXPECT_TRUE(has(1));
}

TEST_F(StoreWithResults, RootsStayWhateverTheLimits)
{
    const std::string pinned = add(1);
    const std::string linked = add(2);
    const std::string of_run = add(3);
    add(4);
    pin(store_, "paper", {pinned});
    store_.link(linked, folder_ / "out/mesh.safetensors");
    RunFile(store_, "indoor")
        .add({.scan = "room",
              .stage = "toy",
              .variant = {},
              .state = "computed",
              .key = key(3).hex,
              .outputs = {{"mesh", of_run}},
              .seconds = 1.0,
              .peak_memory = 0,
              .exit_code = 0,
              .words = {}});
    for (const int number : {1, 2, 3, 4})
        was_used_days_ago(number, 100);
    const GcOptions options{.max_size = 1, .older_than = 1.0, .keep_last = {}, .is_dry = false};
    const GcReport report = collect_garbage(store_, options);
    EXPECT_TRUE(has(1) && has(2) && has(3));
    EXPECT_FALSE(has(4));
    std::string reasons;
    for (const auto& item : report.kept)
        reasons += item.why + "\n";
    EXPECT_THAT(reasons,
                AllOf(HasSubstr("pinned as 'paper'"), HasSubstr("a folder of results links it"), HasSubstr("used it")));
    EXPECT_TRUE(unpin(store_, "paper"));
    for (const int number : {1, 3}) // finding them marked them as used
        was_used_days_ago(number, 100);
    collect_garbage(store_, {.max_size = {}, .older_than = 1.0, .keep_last = 0, .is_dry = false});
    EXPECT_FALSE(has(1) || has(3));
    EXPECT_TRUE(has(2));
}

TEST_F(StoreWithResults, WhatALiveProcessNeedsIsNotTouched)
{
    const std::string input = add(1);
    const std::string output = add(2);
    fs::remove(store_.entry(key(2).hex)); // as between the object and its entry
    was_used_days_ago(1, 100);
    {
        Lease lease(store_, key(2), {input});
        lease.keep(output);
        collect_garbage(store_, {.max_size = 1, .older_than = 1.0, .keep_last = 0, .is_dry = false});
        EXPECT_TRUE(fs::exists(store_.object(input)) && fs::exists(store_.object(output)));
        EXPECT_TRUE(fs::exists(store_.lease(key(2).hex)));
    }
    was_used_days_ago(1, 100);
    collect_garbage(store_, {.max_size = 1, .older_than = 1.0, .keep_last = 0, .is_dry = false});
    EXPECT_FALSE(fs::exists(store_.object(input)) || fs::exists(store_.object(output)));
}

TEST_F(StoreWithResults, AClockThatWasSetBackLosesNothing)
{
    add(1);
    was_used_days_ago(1, -400); // used in the future
    collect_garbage(store_, {.max_size = {}, .older_than = 1.0, .keep_last = {}, .is_dry = false});
    EXPECT_TRUE(has(1));
}

TEST_F(StoreWithResults, DamageIsNamedAndComputedAgain)
{
    const std::string flipped = add(1), truncated = add(2), missing = add(3);
    add(4);
    EXPECT_TRUE(verify_store(store_, true).damage.empty());
    damage(flipped, 1);
    fs::permissions(store_.object(truncated), fs::perms::owner_all);
    fs::resize_file(store_.object(truncated), fs::file_size(store_.object(truncated)) - 3);
    fs::remove(store_.object(missing));
    EXPECT_TRUE(has(1)); // a flipped bit shows to those who read it
    const VerifyReport report = verify_store(store_, true);
    ASSERT_THAT(report.damage, SizeIs(3));
    std::string text;
    for (const auto& [what, found] : report.damage)
        text += what + ": " + found + "\n";
    EXPECT_THAT(text, AllOf(HasSubstr("tensor 'number' is damaged"), HasSubstr("truncated"), HasSubstr("is missing"),
                            HasSubstr("output 'mesh' of toy"), HasSubstr(flipped)));
    EXPECT_FALSE(has(1) || has(2) || has(3)); // taken out
    for (const int number : {1, 2, 3})
        add(number);
    EXPECT_TRUE(has(1) && has(2) && has(3) && has(4));
    EXPECT_TRUE(verify_store(store_, true).damage.empty());
}

} // namespace
} // namespace quoin
