#include "store/lease.h"

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/log.h"

#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <ctime>
#include <fcntl.h>
#include <fmt/format.h>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace quoin {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using namespace std::chrono_literals;

constexpr auto kHeartbeat = 5s;
constexpr auto kStale = 4 * kHeartbeat; // a holder elsewhere that was not heard of for this long is gone

std::string first_line_of(const std::string& file)
{
    std::ifstream stream(file);
    std::string line;
    std::getline(stream, line);
    return line;
}

// A boot of a host: process ids and locks are of one.
const std::string& this_boot()
{
    static const std::string boot = first_line_of("/proc/sys/kernel/random/boot_id");
    return boot;
}

std::string host_name()
{
    char name[256] = "?";
    ::gethostname(name, sizeof(name) - 1);
    return name;
}

std::string describe_this_process()
{
    Json json = {{"host", host_name()}, {"pid", ::getpid()}, {"boot", this_boot()}};
    if (const char* job = std::getenv("SLURM_JOB_ID")) json["slurm_job"] = job;
    return json.dump() + "\n";
}

Json holder_of(const fs::path& file)
{
    Json holder = Json::parse(first_line_of(file.string()), nullptr, false);
    return holder.is_object() ? holder : Json::object();
}

timespec time_of(const fs::path& file)
{
    struct stat status {};
    ::stat(file.c_str(), &status);
    return status.st_mtim;
}

bool operator==(const timespec& a, const timespec& b) { return a.tv_sec == b.tv_sec && a.tv_nsec == b.tv_nsec; }

bool is_of_other_host(const Json& holder) { return holder.contains("boot") && holder["boot"] != this_boot(); }

// Seconds since the file was touched, by the clock of its own file system.
double age_of(const fs::path& file)
{
    const TemporaryPath probe(file);
    const int descriptor = ::open(probe.path().c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0644);
    if (descriptor < 0) return 0.0;
    struct stat status {};
    ::fstat(descriptor, &status);
    ::close(descriptor);
    return static_cast<double>(status.st_mtim.tv_sec - time_of(file).tv_sec);
}

} // namespace

HeldFile::HeldFile(fs::path path, End end) : path_(std::move(path)), end_(end)
{
    while (!try_take()) {
    }
    if (descriptor_ < 0) return;
    wait_for_other_host();
    const std::string text = describe_this_process();
    if (::ftruncate(descriptor_, 0) == 0 && ::write(descriptor_, text.data(), text.size()) < 0)
        log_debug(fmt::format("{}: cannot write", path_.string())); // it is held all the same
    heart_ = std::thread([this] { beat(); });
}

// False when the file that was locked was removed meanwhile by the one who held it before.
bool HeldFile::try_take()
{
    descriptor_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
    if (descriptor_ < 0) return true;
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
        log_info(fmt::format("waiting for {}, which computes the same", holder_text(path_)));
        while (::flock(descriptor_, LOCK_EX) != 0 && errno == EINTR) {
        }
    }
    struct stat held {
    }, named{};
    ::fstat(descriptor_, &held);
    if (::stat(path_.c_str(), &named) == 0 && held.st_ino == named.st_ino && held.st_dev == named.st_dev) return true;
    ::close(descriptor_);
    return false;
}

// The lock is ours, but locks may not reach the host that wrote the file: it is gone when its heart stands still. That
// is measured here, whatever the clocks say.
void HeldFile::wait_for_other_host() const
{
    if (!is_of_other_host(holder_of(path_))) return;
    log_info(fmt::format("waiting for {}, which computes the same, or its end", holder_text(path_)));
    auto last_heard = std::chrono::steady_clock::now();
    timespec beat = time_of(path_);
    while (std::chrono::steady_clock::now() - last_heard < kStale) {
        std::this_thread::sleep_for(200ms);
        struct stat status {};
        ::fstat(descriptor_, &status);
        if (status.st_nlink == 0 || !is_of_other_host(holder_of(path_))) return; // it has released the file
        if (status.st_mtim == beat) continue;
        beat = status.st_mtim;
        last_heard = std::chrono::steady_clock::now();
    }
}

void HeldFile::beat()
{
    std::unique_lock lock(mutex_);
    while (!ends_.wait_for(lock, kHeartbeat, [&] { return is_ending_; }))
        ::futimens(descriptor_, nullptr);
}

HeldFile::~HeldFile()
{
    if (descriptor_ < 0) return;
    {
        const std::lock_guard lock(mutex_);
        is_ending_ = true;
    }
    ends_.notify_one();
    heart_.join();
    if (end_ == End::Remove) ::unlink(path_.c_str());
    ::close(descriptor_);
}

void HeldFile::add_line(const std::string& text)
{
    const std::string line = text + "\n";
    if (descriptor_ >= 0 && ::write(descriptor_, line.data(), line.size()) < 0)
        log_debug(fmt::format("{}: cannot write", path_.string()));
}

bool is_held(const fs::path& file)
{
    const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) return false;
    const bool is_locked = ::flock(descriptor, LOCK_SH | LOCK_NB) != 0;
    ::close(descriptor);
    return is_locked ||
           (is_of_other_host(holder_of(file)) && age_of(file) < std::chrono::duration<double>(kStale).count());
}

std::vector<std::string> lines_of(const fs::path& file)
{
    std::vector<std::string> lines;
    std::istringstream stream(read_text(file));
    std::string line;
    for (bool is_first = true; std::getline(stream, line); is_first = false)
        if (!is_first) lines.push_back(line);
    return lines;
}

std::string holder_text(const fs::path& file)
{
    const Json holder = holder_of(file);
    std::string text = fmt::format("process {} on host {}", holder.value("pid", 0), holder.value("host", "?"));
    if (holder.contains("slurm_job")) text += fmt::format(", Slurm job {}", holder.value("slurm_job", ""));
    return text;
}

Lease::Lease(const Store& store, const Key& key, const std::vector<std::string>& payloads)
    : file_(store.lease(key.hex), HeldFile::End::Remove)
{
    for (const auto& payload : payloads)
        keep(payload);
}

} // namespace quoin
