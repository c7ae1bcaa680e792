#include "foreign/check_artifact.h"

#include "schema/schema.h"

#include <functional>
#include <map>

namespace quoin {

void check_artifact(const std::filesystem::path& path, const std::string& schema)
{
    static const std::map<std::string, std::function<void(const std::filesystem::path&)>> readers = {
        {"scan", read_scan},           {"mesh", read_mesh},
        {"keyframes", read_keyframes}, {"plane_mesh", read_plane_mesh},
        {"lines", read_lines},         {"alignment", read_alignment},
        {"metrics", read_metrics},     {"textured_mesh", read_textured_mesh}};
    const auto reader = readers.find(schema);
    if (reader == readers.end())
        read_artifact(path, schema); // a schema of somebody else's: the container alone is checked
    else
        reader->second(path);
}

} // namespace quoin
