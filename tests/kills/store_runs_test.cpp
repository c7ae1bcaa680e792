// What becomes of runs when the store is moved, damaged, full, read-only or gone, by the real driver and small real
// stages.
#include "build_paths.h"
#include "kills/toy_runs.h"

#include "base/atomic_file.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/mount.h>
#include <unistd.h>

namespace quoin {
namespace {

namespace fs = std::filesystem;
using test::CommandResult;
using test::Digests;
using test::ToyRuns;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class StoreRuns : public testing::Test {
protected:
    CommandResult run(const std::string& options = {}, const std::string& out = "out",
                      const std::string& store = "store")
    {
        return test::run_command(runs_.command(out, store, options));
    }

    fs::path object_of(const std::string& output)
    {
        const std::string payload = runs_.digests("out").at(output);
        return runs_.path("store/v1/cas") / payload.substr(0, 2) / payload;
    }

    static void flip_last_byte(const fs::path& file)
    {
        fs::permissions(file, fs::perms::owner_all);
        std::fstream stream(file, std::ios::binary | std::ios::in | std::ios::out);
        stream.seekg(-1, std::ios::end);
        const char byte = static_cast<char>(stream.peek() ^ 1);
        stream.seekp(-1, std::ios::end);
        stream.put(byte);
    }

    ToyRuns runs_;
};

TEST_F(StoreRuns, ARunWithNothingToDoReadsNoArtifact)
{
    ASSERT_EQ(run().exit_code, 0);
    for (const auto& object : fs::recursive_directory_iterator(runs_.path("store/v1/cas"))) {
        if (!object.is_regular_file()) continue;
        const auto size = object.file_size(); // only zeros are left, as many as before: reading any of them would fail
        fs::permissions(object.path(), fs::perms::owner_all);
        fs::resize_file(object.path(), 0);
        fs::resize_file(object.path(), size);
    }
    const CommandResult again = run();
    EXPECT_EQ(again.exit_code, 0);
    EXPECT_THAT(again.output, HasSubstr("nothing to compute: 5 stages in the store"));
}

TEST_F(StoreRuns, NoStageIsStartedForWhatTheStoreHas)
{
    for (const char* name : {"toy-source", "toy-scale", "toy-join", "toy-folder"}) {
        const fs::path script = runs_.path("stages") / name;
        fs::remove(script);
        std::ofstream(script) << "#!/bin/bash\n[ \"$1\" = --describe ] || echo " << name << " >> '"
                              << runs_.path("log").string() << "'\nexec -a " << name << " " QUOIN_BINARY_DIR
                              << "/bin/toy_path \"$@\"\n";
        fs::permissions(script, fs::perms::owner_all);
    }
    ASSERT_EQ(run().exit_code, 0);
    EXPECT_EQ(std::ranges::count(read_text(runs_.path("log")), '\n'), 5);
    fs::remove(runs_.path("log"));
    fs::remove_all(runs_.path("out")); // the driver itself puts them in their places
    EXPECT_THAT(run().output, HasSubstr("nothing to compute"));
    EXPECT_FALSE(fs::exists(runs_.path("log")));
    EXPECT_TRUE(fs::exists(runs_.path("out/room/join/mesh.safetensors")));
    EXPECT_TRUE(fs::exists(runs_.path("out/room/folder/model/sum.txt")));
    EXPECT_THAT(run("-S left.factor=5").output, HasSubstr("3 stages computed")); // left, join, folder
}

TEST_F(StoreRuns, WhatComesOutAsBeforeCutsOffWhatFollows)
{
    ASSERT_EQ(run().exit_code, 0);
    // Other frames, but the toy source makes the same mesh of them.
    std::ofstream(runs_.path("room/frame2")) << "another";
    EXPECT_THAT(run().output, HasSubstr("1 stage computed"));
}

TEST_F(StoreRuns, AStageByHandFillsAndUsesTheSameStore)
{
    ASSERT_EQ(run().exit_code, 0);
    const std::string by_hand = "cd '" + runs_.path(".").string() +
                                "' && exec stages/toy-scale --in mesh=out/room/source/mesh.safetensors "
                                "--out mesh=hand.safetensors --store store --set factor=";
    EXPECT_EQ(test::run_command(by_hand + "3.0 --cache only").exit_code, 0); // as `right`
    EXPECT_EQ(test::run_command(by_hand + "7").exit_code, 0);
    EXPECT_THAT(run("-S right.factor=7 --until right").output, HasSubstr("nothing to compute"));
    const std::string key = test::run_command(by_hand + "7 --key").output.substr(0, 64);
    EXPECT_EQ(read_run_record(runs_.path("out/room/right/record.json"))->key, key);
}

TEST_F(StoreRuns, MovingStoreAndDataKeepsEverythingValid)
{
    ASSERT_EQ(run().exit_code, 0);
    for (const auto& file : fs::recursive_directory_iterator(runs_.path("store")))
        if (file.is_regular_file() && file.path().filename() != "lock") {
            const std::string text = read_text(file.path());
            EXPECT_EQ(text.find(runs_.path("").string()), std::string::npos) << file.path();
        }
    fs::create_directories(runs_.path("elsewhere/deep"));
    fs::copy(runs_.path("store"), runs_.path("elsewhere/deep/store"), fs::copy_options::recursive);
    fs::remove_all(runs_.path("store"));
    fs::rename(runs_.path("room"), runs_.path("moved"));
    const CommandResult again =
        test::run_command(runs_.shell("run p.yaml --scan room=moved --out out2 --store elsewhere/deep/store"));
    EXPECT_THAT(again.output, HasSubstr("nothing to compute"));
}

TEST_F(StoreRuns, ADamagedInputIsNamedAndComputedAgain)
{
    ASSERT_EQ(run().exit_code, 0);
    const Digests before = runs_.digests("out");
    const fs::path damaged = object_of("source.mesh");
    flip_last_byte(damaged);
    const CommandResult again = run("-S left.factor=9"); // left reads it
    EXPECT_EQ(again.exit_code, 0) << again.output;
    EXPECT_THAT(again.output, AllOf(HasSubstr("is damaged"), HasSubstr("source"), HasSubstr("computing it again")));
    EXPECT_EQ(runs_.digests("out").at("source.mesh"), before.at("source.mesh"));
    EXPECT_EQ(runs_.quoin("verify --store store").exit_code, 0);
}

TEST_F(StoreRuns, ATruncatedOrMissingResultIsNamedAndComputedAgain)
{
    ASSERT_EQ(run().exit_code, 0);
    const Digests before = runs_.digests("out");
    const fs::path truncated = object_of("left.mesh"), missing = object_of("join.mesh");
    fs::permissions(truncated, fs::perms::owner_all);
    fs::resize_file(truncated, fs::file_size(truncated) / 2);
    fs::remove(missing);
    const CommandResult again = run();
    EXPECT_EQ(again.exit_code, 0) << again.output;
    EXPECT_THAT(again.output,
                AllOf(HasSubstr(truncated.filename().string()), HasSubstr("instead of"),
                      HasSubstr(missing.filename().string()), HasSubstr("is missing"), HasSubstr("2 stages computed")));
    EXPECT_EQ(runs_.digests("out"), before);
    EXPECT_EQ(runs_.quoin("verify --store store").exit_code, 0);
}

TEST_F(StoreRuns, VerifyTakesDamageOutOfTheStore)
{
    ASSERT_EQ(run().exit_code, 0);
    flip_last_byte(object_of("join.mesh"));
    flip_last_byte(object_of("folder.model") / "sum.txt");
    const CommandResult kept = runs_.quoin("verify --store store --keep");
    EXPECT_EQ(kept.exit_code, 1);
    EXPECT_THAT(kept.output, AllOf(HasSubstr("tensor 'position' is damaged"), HasSubstr("output 'mesh' of toy-join"),
                                   HasSubstr("output 'model' of toy-folder"), HasSubstr("2 damaged")));
    EXPECT_EQ(runs_.quoin("verify --store store").exit_code, 1);
    EXPECT_THAT(run().output, HasSubstr("2 stages computed"));
    EXPECT_EQ(runs_.quoin("verify --store store").exit_code, 0);
}

TEST_F(StoreRuns, VerifyComputesAgainWithOtherThreadCounts)
{
    ASSERT_EQ(run().exit_code, 0);
    const CommandResult again = runs_.quoin("verify --rerun --threads 1,3 --store store --scan room");
    EXPECT_EQ(again.exit_code, 0) << again.output;
    EXPECT_THAT(again.output, AllOf(HasSubstr("same bytes with 1 thread"), HasSubstr("same bytes with 3 threads"),
                                    Not(HasSubstr("skipped"))));
    EXPECT_THAT(runs_.quoin("verify --rerun --store store --stage toy-source").output,
                HasSubstr("name its folder with --scan"));
    EXPECT_TRUE(fs::is_empty(runs_.path("store/v1/tmp")));
}

TEST_F(StoreRuns, AFailingDiskIsOneMessageAndKeepsWhatWasComputed)
{
    for (const char* error : {"EIO", "ENOSPC"}) {
        const std::string seed = std::string("-S source.seed=") + (error[1] == 'I' ? "11" : "12");
        const auto failed = test::run_command(std::string("export QUOIN_FAIL_POINT=toy-join/entry_written=") + error +
                                              "; " + runs_.command("out", "store", seed));
        EXPECT_EQ(failed.exit_code, 4);
        EXPECT_EQ(failed.output.find("error:"), failed.output.rfind("error:")) << failed.output;
        EXPECT_THAT(failed.output, HasSubstr("cannot write: "));
        EXPECT_TRUE(fs::is_empty(runs_.path("store/v1/tmp")));
        EXPECT_EQ(run(seed).exit_code, 0);
    }
}

// Bounds what may be written as a small disk would; needs root.
TEST_F(StoreRuns, AFullDiskIsOneMessageAndKeepsWhatWasComputed)
{
    fs::create_directories(runs_.path("small"));
    if (::mount("none", runs_.path("small").c_str(), "tmpfs", 0, "size=200k") != 0)
        GTEST_SKIP() << "cannot mount a small disk";
    const CommandResult full = run("", "out", "small/store");
    EXPECT_EQ(full.exit_code, 4) << full.output;
    EXPECT_THAT(full.output, AllOf(HasSubstr("small/store"), HasSubstr("No space left on device")));
    EXPECT_EQ(full.output.find("error:"), full.output.rfind("error:")) << full.output;
    const auto stored = runs_.files("small/store/v1/ac").size();
    EXPECT_GE(stored, 1U); // the first stages fitted, and stay
    EXPECT_TRUE(fs::is_empty(runs_.path("small/store/v1/tmp")));
    EXPECT_EQ(::mount("none", runs_.path("small").c_str(), "tmpfs", MS_REMOUNT, "size=8m"), 0);
    EXPECT_THAT(run("", "out", "small/store").output, HasSubstr(std::to_string(stored) + " in the store"));

    EXPECT_EQ(::mount("none", runs_.path("small").c_str(), "tmpfs", MS_REMOUNT | MS_RDONLY, nullptr), 0);
    EXPECT_THAT(run("", "out2", "small/store").output, HasSubstr("nothing to compute")); // a read-only store serves
    const CommandResult more = run("-S left.factor=9", "out2", "small/store");
    EXPECT_EQ(more.exit_code, 0) << more.output;
    EXPECT_THAT(more.output, HasSubstr("the store is read-only; the result will not be kept in it"));
    EXPECT_TRUE(fs::exists(runs_.path("out2/room/folder/model/sum.txt")));
    ::umount(runs_.path("small").c_str());

    // The disk has vanished: an empty folder is left of it, or a file.
    fs::remove(runs_.path("small"));
    write_atomically(runs_.path("small"), std::string_view("x"));
    const CommandResult gone = run("", "out", "small/store");
    EXPECT_NE(gone.exit_code, 0);
    EXPECT_THAT(gone.output, AllOf(HasSubstr("small/store"), HasSubstr("--store")));
    EXPECT_EQ(std::ranges::count(gone.output, '\n'), 1) << gone.output;
}

TEST_F(StoreRuns, TheLogSaysWhatRan)
{
    ASSERT_EQ(run().exit_code, 0);
    ASSERT_EQ(run("-S left.factor=9").exit_code, 0);
    const CommandResult list = runs_.quoin("log --store store");
    EXPECT_THAT(list.output, AllOf(HasSubstr("5 computed"), HasSubstr("2 cached, 3 computed"), HasSubstr("done")));
    EXPECT_THAT(runs_.quoin("log last join --store store").output, AllOf(HasSubstr("join"), Not(HasSubstr("folder "))));
    EXPECT_THAT(runs_.quoin("du --store store").output, AllOf(HasSubstr("toy-scale"), HasSubstr("temporaries 0 B")));
}

} // namespace
} // namespace quoin
