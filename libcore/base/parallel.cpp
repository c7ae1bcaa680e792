#include "base/parallel.h"

#include <atomic>
#include <memory>
#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>

#ifdef __SANITIZE_THREAD__
extern "C" void __tsan_acquire(void* token); // GCC's libtsan, declared in no header of its own
extern "C" void __tsan_release(void* token);
#endif

namespace quoin {
namespace {

// Chunks begin after parallel_chunks was called and end before it returns. TBB sees to that; the thread sanitizer has
// to be told, since Debian's TBB is built without it.
class HandOver {
public:
#ifdef __SANITIZE_THREAD__
    void give() { __tsan_release(this); }
    void take() { __tsan_acquire(this); }
#else
    void give() {}
    void take() {}
#endif
};

std::atomic<int> threads_wanted{0};

std::unique_ptr<tbb::global_control>& limit()
{
    static std::unique_ptr<tbb::global_control> control;
    return control;
}

} // namespace

void set_thread_count(int threads)
{
    threads_wanted = threads;
    limit().reset();
    limit() = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                    static_cast<std::size_t>(thread_count()));
}

int thread_count()
{
    const int wanted = threads_wanted;
    return wanted > 0 ? wanted : tbb::info::default_concurrency();
}

void parallel_chunks(std::size_t count, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& body)
{
    if (count == 0) return;
    const std::size_t chunks = (count + grain - 1) / grain;
    const auto run = [&](std::size_t chunk) { body(chunk * grain, std::min(count, (chunk + 1) * grain)); };
    if (chunks == 1 || thread_count() == 1) {
        for (std::size_t chunk = 0; chunk < chunks; ++chunk)
            run(chunk);
        return;
    }
    HandOver begin, end;
    begin.give();
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, chunks, 1),
        [&](const tbb::blocked_range<std::size_t>& range) {
            begin.take();
            for (std::size_t chunk = range.begin(); chunk != range.end(); ++chunk)
                run(chunk);
            end.give();
        },
        tbb::simple_partitioner());
    end.take();
}

} // namespace quoin
