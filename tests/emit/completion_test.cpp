// Completion as the shells themselves run it, on the toy stages.
#include "build_paths.h"
#include "support/workshop.h"

#include <gmock/gmock.h>

namespace quoin {
namespace {

using test::run_command;
using test::Workshop;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

// What completing the last of `words` (the first is quoin) offers.
std::string offered_by_bash(const Workshop& shop, const std::string& words)
{
    return shop
        .shell("bash -c 'source <(" QUOIN_BINARY_DIR "/bin/quoin emit completion bash); COMP_WORDS=(" + words +
               "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _quoin 2>/dev/null; echo \"${COMPREPLY[@]}\"'")
        .output;
}

std::string offered_by_zsh(const Workshop& shop, const std::string& words)
{
    return shop
        .shell("zsh -fc 'compadd() { print -- \"$@\" }; _files() { print files }; source <(" QUOIN_BINARY_DIR
               "/bin/quoin emit completion zsh); words=(" +
               words + "); CURRENT=${#words}; _quoin'")
        .output;
}

TEST(Completion, OffersVerbsStagesOptionsAndSettingsInBash)
{
    const Workshop shop({"a"});
    EXPECT_EQ(offered_by_bash(shop, "quoin subm"), "submit\n");
    EXPECT_EQ(offered_by_bash(shop, "quoin wei"), "weigh\n");
    EXPECT_THAT(offered_by_bash(shop, "quoin run --k"), HasSubstr("--keep-going"));
    EXPECT_EQ(offered_by_bash(shop, "quoin run -S scale.f"), "scale.factor=\n");
    EXPECT_EQ(offered_by_bash(shop, "quoin scale --set f"), "factor=\n");
    EXPECT_EQ(offered_by_bash(shop, "quoin join --in o"), "other=\n");
    EXPECT_EQ(offered_by_bash(shop, "quoin run --until j"), "join\n");
    EXPECT_EQ(offered_by_bash(shop, "quoin emit n"), "ninja\n");
}

TEST(Completion, OffersTheSameInZsh)
{
    if (run_command("command -v zsh").exit_code != 0) GTEST_SKIP() << "zsh is not installed";
    const Workshop shop({"a"});
    EXPECT_THAT(offered_by_zsh(shop, "quoin subm"), AllOf(HasSubstr("submit"), HasSubstr("weigh")));
    EXPECT_THAT(offered_by_zsh(shop, "quoin run --k"), AllOf(HasSubstr("--keep-going"), Not(HasSubstr("weigh"))));
    EXPECT_THAT(offered_by_zsh(shop, "quoin run -S scale.f"), HasSubstr("scale.factor="));
    EXPECT_EQ(offered_by_zsh(shop, "quoin join --in o"), "-S  -- mesh= other=\n");
    EXPECT_EQ(offered_by_zsh(shop, "quoin inspect o"), "files\n");
}

} // namespace
} // namespace quoin
