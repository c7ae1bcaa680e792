#include "pipeline/yaml.h"

#include <gmock/gmock.h>

namespace quoin {
namespace {

using testing::HasSubstr;

std::string yaml_problems(const std::string& text)
{
    Problems problems;
    parse_yaml("p.yaml", text, problems);
    return problems.text();
}

TEST(Yaml, KnowsWhereEveryNodeStands)
{
    Problems problems;
    const YamlNode node = parse_yaml("p.yaml", "a: 1\nb:\n  c: two\n", problems);
    EXPECT_TRUE(problems.empty());
    const YamlNode* c = find(*find(node, "b"), "c");
    ASSERT_NE(c, nullptr);
    EXPECT_EQ(c->text, "two");
    EXPECT_EQ(to_string(c->position), "p.yaml:3:6");
}

TEST(Yaml, RefusesAKeyThatStandsTwice)
{
    EXPECT_EQ(yaml_problems("a: 1\nb: 2\na: 3\n"),
              "p.yaml:3:1: key 'a' stands here a second time; the first is in line 1\n"
              "  3 | a: 3\n"
              "    | ^");
}

TEST(Yaml, RefusesTheSecondOfTwoEqualKeysInAFlowMap)
{
    EXPECT_THAT(yaml_problems("s: {x: 1, y: 2, x: 3}\n"), HasSubstr("p.yaml:1:17: key 'x' stands here a second time"));
}

TEST(Yaml, RefusesATabInTheIndentation)
{
    EXPECT_THAT(yaml_problems("a:\n\tb: 1\n"),
                HasSubstr("p.yaml:2:1: a tab in the indentation; YAML takes blanks only"));
}

TEST(Yaml, SaysWhereTheTextStopsBeingYaml)
{
    EXPECT_THAT(yaml_problems("a: {b: 1\nc: [2\n"), HasSubstr("this is not YAML"));
    EXPECT_THAT(yaml_problems("a: {b: 1\nc: [2\n"), HasSubstr("p.yaml:"));
}

TEST(Yaml, RefusesASecondDocument) { EXPECT_THAT(yaml_problems("a: 1\n---\nb: 2\n"), HasSubstr("a second document")); }

TEST(Yaml, RefusesKeysThatAreNotText)
{
    EXPECT_THAT(yaml_problems("[1, 2]: 3\n"), HasSubstr("a key must be a plain word"));
}

TEST(Yaml, RefusesAliasesThatBlowTheDocumentUp)
{
    std::string text = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n";
    for (int i = 1; i < 8; ++i) {
        const std::string below = "*a" + std::to_string(i - 1);
        text += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [";
        for (int k = 0; k < 10; ++k)
            text += (k ? ", " : "") + below;
        text += "]\n";
    }
    EXPECT_THAT(yaml_problems(text), HasSubstr("blown up by aliases"));
}

TEST(Yaml, KeepsScalarsAsTheyAreWritten)
{
    Problems problems;
    const YamlNode node = parse_yaml("p.yaml", "a: 012\nb: yes\nc: \"x y\"\n", problems);
    EXPECT_EQ(find(node, "a")->text, "012");
    EXPECT_EQ(find(node, "b")->text, "yes");
    EXPECT_EQ(find(node, "c")->text, "x y");
}

TEST(Yaml, PutsTheCaretUnderTheColumnOfALineWithTabs)
{
    Problems problems;
    problems.add({make_source("p.yaml", "a:\tb"), 1, 4}, "bad");
    EXPECT_EQ(problems.text(), "p.yaml:1:4: bad\n  1 | a: b\n    |    ^");
}

} // namespace
} // namespace quoin
