// Who computes a key now. A lease only saves double work and tells gc what is in use; nothing is wrong without it. The
// kernel releases it when the process ends, however that ends.
#pragma once

#include "store/store.h"

#include <condition_variable>
#include <filesystem>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace quoin {

// A file that this process holds: locked, with the holder's host, process and job in it, and touched every few seconds
// for file systems on which locks do not reach other hosts. Lines may be added to it.
class HeldFile {
public:
    enum class End { Remove, Keep }; // what becomes of the file when it is released

    // Waits while another process holds it, saying who. Where the file cannot be made (a read-only store) nothing is
    // held.
    HeldFile(std::filesystem::path path, End end);
    ~HeldFile();
    HeldFile(const HeldFile&) = delete;
    HeldFile& operator=(const HeldFile&) = delete;

    void add_line(const std::string& text);

private:
    bool try_take();
    void wait_for_other_host() const;
    void beat();

    std::filesystem::path path_;
    End end_;
    int descriptor_ = -1;
    std::mutex mutex_;
    std::condition_variable ends_;
    bool is_ending_ = false;
    std::thread heart_;
};

// True while a process holds the file: by its lock on this host, by its heartbeat elsewhere.
bool is_held(const std::filesystem::path& file);

// The lines of a held file but the first, which says who holds it.
std::vector<std::string> lines_of(const std::filesystem::path& file);
std::string holder_text(const std::filesystem::path& file); // "process 12 on host a, Slurm job 7"

// Held while a key is computed. Names the payloads that the computation needs and makes, so that gc leaves them.
class Lease {
public:
    Lease(const Store& store, const Key& key, const std::vector<std::string>& payloads);
    void keep(const std::string& payload) { file_.add_line(payload); }

private:
    HeldFile file_;
};

} // namespace quoin
