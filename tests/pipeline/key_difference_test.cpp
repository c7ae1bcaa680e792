#include "pipeline/key_difference.h"

#include "store/key.h"

#include <gmock/gmock.h>

namespace quoin {
namespace {

KeyParts parts()
{
    return {"simplify",
            "builtin/simplify",
            3,
            {{"plane_mesh", "plane_mesh/1"}},
            {{"max_error", 0.1}, {"method", std::string("qem")}, {"rounds", std::int64_t{2}}},
            {{"plane_mesh", {"plane_mesh/1", "aa"}}}};
}

std::string text(const std::vector<KeyChange>& changes)
{
    std::string text;
    for (const auto& change : changes)
        text += change.name + " " + change.before + " -> " + change.after + "\n";
    return text;
}

TEST(KeyDifference, IsNothingForEqualKeys)
{
    EXPECT_TRUE(key_difference(make_key(parts()).json, make_key(parts()).json).empty());
}

TEST(KeyDifference, NamesParametersWithOldAndNewValue)
{
    KeyParts changed = parts();
    changed.params["max_error"] = 0.25;
    changed.params["method"] = std::string("other");
    changed.params.erase("rounds");
    EXPECT_EQ(text(key_difference(make_key(parts()).json, make_key(changed).json)),
              "max_error 0.1 -> 0.25\nmethod qem -> other\nrounds 2 -> \n");
}

TEST(KeyDifference, NamesVersionsAndInputs)
{
    KeyParts changed = parts();
    changed.impl_version = 4;
    changed.inputs["plane_mesh"].payload = "bb";
    const auto changes = key_difference(make_key(parts()).json, make_key(changed).json);
    EXPECT_EQ(text(changes), "impl_version 3 -> 4\nplane_mesh sha256:aa -> sha256:bb\n");
    EXPECT_EQ(changes[1].kind, KeyChange::Kind::Input);
}

TEST(KeyDifference, TakesADamagedKeyForAnother) { EXPECT_FALSE(key_difference("{", make_key(parts()).json).empty()); }

} // namespace
} // namespace quoin
