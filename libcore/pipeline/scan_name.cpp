#include "pipeline/scan_name.h"

namespace quoin {

std::string scan_name(const std::filesystem::path& folder)
{
    const auto path = folder.lexically_normal();
    return path.has_filename() ? path.filename() : path.parent_path().filename();
}

} // namespace quoin
