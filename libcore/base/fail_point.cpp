#include "base/fail_point.h"

#include "base/error.h"

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <string>
#include <unistd.h>

namespace quoin {
namespace {

struct FailPoint {
    std::string name;
    int hits = 1;  // at which it acts
    int error = 0; // 0 = killed
};

FailPoint from_environment()
{
    const char* variable = std::getenv("QUOIN_FAIL_POINT");
    FailPoint point{variable ? variable : "", 1, 0};
    if (const auto slash = point.name.find('/'); slash != std::string::npos) {
        if (point.name.substr(0, slash) != program_invocation_short_name) return {};
        point.name.erase(0, slash + 1);
    }
    if (const auto equals = point.name.find('='); equals != std::string::npos) {
        point.error = point.name.substr(equals + 1) == "ENOSPC" ? ENOSPC : EIO;
        point.name.resize(equals);
    }
    if (const auto colon = point.name.find(':'); colon != std::string::npos) {
        point.hits = std::atoi(point.name.c_str() + colon + 1);
        point.name.resize(colon);
    }
    return point;
}

} // namespace

void fail_point(const char* name, const std::filesystem::path& path)
{
    static const FailPoint point = from_environment();
    static std::atomic<int> hits = 0;
    if (point.name != name || ++hits != point.hits) return;
    if (point.error == 0) ::kill(::getpid(), SIGKILL);
    throw ResourceError(path.string() + ": cannot write: " + std::strerror(point.error));
}

} // namespace quoin
