// What `quoin emit make` and `emit ninja` write is run by make and ninja themselves: they give the digests of
// `quoin run`, and do again what they should and nothing else.
#include "support/workshop.h"

#include <gmock/gmock.h>

namespace quoin {
namespace {

namespace fs = std::filesystem;
using test::CommandResult;
using test::Digests;
using test::Workshop;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

// The tools, with how each is called on an emitted file and what it says when there is nothing to do.
struct Tool {
    std::string name, call, idle;
};

class EmitTest : public testing::TestWithParam<Tool> {
protected:
    CommandResult emit(const std::string& options)
    {
        return shop_.quoin("emit " + GetParam().name + " p.yaml" + shop_.scan_options() + " --out made " + options);
    }
    CommandResult make() { return shop_.shell(GetParam().call + " made/file"); }
    void emit_and_make(const std::string& options = "")
    {
        const CommandResult emitted = emit("--to made/file " + options);
        ASSERT_EQ(emitted.exit_code, 0) << emitted.output;
        const CommandResult made = make();
        ASSERT_EQ(made.exit_code, 0) << made.output;
    }
    Digests digests_of_run(const std::string& options = "")
    {
        const CommandResult run = shop_.quoin("run p.yaml" + shop_.scan_options() + " --out run " + options);
        EXPECT_EQ(run.exit_code, 0) << run.output;
        return shop_.digests("run");
    }
    bool is_idle() { return make().output.find(GetParam().idle) != std::string::npos; }

    void SetUp() override { fs::create_directories(shop_ / "made"); }
    Workshop shop_{{"kitchen", "hall-2"}};
};

TEST_P(EmitTest, GivesTheDigestsOfTheDriver)
{
    emit_and_make();
    const Digests made = shop_.digests("made");
    EXPECT_EQ(made.size(), 10U);
    EXPECT_EQ(made, digests_of_run());
    EXPECT_TRUE(is_idle()) << make().output;
}

TEST_P(EmitTest, SharesTheStoreWithTheDriver)
{
    const Digests run = digests_of_run("--store store");
    emit_and_make("--store store");
    EXPECT_EQ(shop_.digests("made"), run);
    for (const auto& scan : {"kitchen", "hall-2"})
        for (const auto& stage : fs::directory_iterator(shop_ / "made" / scan))
            EXPECT_TRUE(read_run_record(stage.path() / "record.json")->cached) << stage.path();
    EXPECT_TRUE(is_idle());
}

TEST_P(EmitTest, RunsWhatAChangedParameterTouches)
{
    emit_and_make();
    const Digests before = shop_.digests("made");
    emit_and_make("-S small.factor=3");
    const Digests after = shop_.digests("made");
    EXPECT_EQ(after, digests_of_run("-S small.factor=3"));
    EXPECT_NE(after.at("kitchen/weigh.metrics"), before.at("kitchen/weigh.metrics"));
    EXPECT_EQ(after.at("kitchen/large.mesh"), before.at("kitchen/large.mesh"));
    EXPECT_TRUE(is_idle());
}

TEST_P(EmitTest, NoticesChangedAddedAndRemovedFilesOfAScan)
{
    emit_and_make();
    shop_.write("scans/kitchen/points.txt", "7 7 7\n");
    ASSERT_EQ(make().exit_code, 0);
    EXPECT_EQ(shop_.digests("made"), digests_of_run());
    EXPECT_TRUE(is_idle());
    shop_.write("scans/kitchen/more/notes.txt", "x");
    EXPECT_FALSE(is_idle());
    EXPECT_TRUE(is_idle());
    fs::remove_all(shop_ / "scans/kitchen/more");
    EXPECT_FALSE(is_idle());
    EXPECT_TRUE(is_idle());
}

TEST_P(EmitTest, MakesARemovedResultAgain)
{
    emit_and_make();
    fs::remove(shop_ / "made/kitchen/join/mesh.safetensors");
    ASSERT_EQ(make().exit_code, 0);
    EXPECT_TRUE(fs::exists(shop_ / "made/kitchen/join/mesh.safetensors"));
    EXPECT_TRUE(is_idle());
}

TEST_P(EmitTest, StopsWhereAStageFailsAndGoesOnFromThere)
{
    shop_.write("scans/kitchen/broken", "");
    ASSERT_EQ(emit("--to made/file").exit_code, 0);
    const CommandResult failed = make();
    EXPECT_NE(failed.exit_code, 0);
    EXPECT_THAT(failed.output, HasSubstr("the scan is broken"));
    EXPECT_FALSE(fs::exists(shop_ / "made/kitchen/read/mesh.safetensors"));
    fs::remove(shop_ / "scans/kitchen/broken");
    EXPECT_EQ(make().exit_code, 0);
    EXPECT_EQ(shop_.digests("made"), digests_of_run());
}

TEST_P(EmitTest, WritesOnlyTheStagesThatAreAskedFor)
{
    const CommandResult until = emit("--until small");
    EXPECT_THAT(until.output, AllOf(HasSubstr("/small/record.json"), Not(HasSubstr("/join/record.json"))));
    EXPECT_EQ(emit("--from join").exit_code, 3);
    ASSERT_EQ(shop_.quoin("run p.yaml" + shop_.scan_options() + " --out made").exit_code, 0);
    EXPECT_THAT(emit("--from join").output, Not(HasSubstr("/small/record.json")));
    emit_and_make("--from join");
}

TEST_P(EmitTest, RefusesNamesThatItsFilesCannotHold)
{
    fs::create_directories(shop_ / "my room");
    const CommandResult result = shop_.quoin("emit " + GetParam().name + " p.yaml --scan 'my room'");
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.output, HasSubstr("the name of a scan is 'my room'"));
}

INSTANTIATE_TEST_SUITE_P(Tools, EmitTest,
                         testing::Values(Tool{"make", "make -j2 -f", "Nothing to be done"},
                                         Tool{"ninja", "ninja -j2 -f", "no work to do"}),
                         [](const auto& tool) { return tool.param.name; });

TEST(EmitVerb, NamesTheFormatsThatThereAre)
{
    const Workshop shop({"a"});
    EXPECT_THAT(shop.quoin("emit mke").output, HasSubstr("there is no format 'mke'; did you mean 'make'?"));
    EXPECT_EQ(shop.quoin("emit").exit_code, 2);
    EXPECT_THAT(shop.quoin("emit --help").output, HasSubstr("quoin emit ninja"));
}

} // namespace
} // namespace quoin
