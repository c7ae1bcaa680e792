#pragma once

#include <string_view>

namespace quoin {

// A file of libcore/report/page, embedded by the build: "report.html", "viewer.js", ... Empty for another name.
std::string_view page_text(std::string_view name);

} // namespace quoin
