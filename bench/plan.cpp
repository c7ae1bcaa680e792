// Plans a run of 100,000 tasks and prints how long each step takes and the peak memory: the pipeline is read and
// checked against the stages, tasks are made for every scan, every key is computed, and the tasks are ordered as a run
// would.
//
//     build/release/bin/bench_plan [SCANS]        default: as many as make 100,000 tasks
#include "pipeline/plan.h"
#include "base/error.h"
#include "base/timer.h"
#include "pipeline/locate.h"
#include "pipeline/pipeline_file.h"
#include "pipeline/ready_queue.h"
#include "pipeline/task_keys.h"

#include <cstdio>
#include <cstdlib>
#include <fmt/format.h>
#include <sys/resource.h>

namespace quoin {
namespace {

constexpr std::size_t kTasks = 100'000;

rusage used()
{
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    return usage;
}

double cpu_seconds()
{
    const auto seconds = [](const timeval& t) {
        return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    const rusage usage = used();
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

// Time by the clock and by the processor, which on a loaded machine is the smaller part.
struct Watch {
    Timer timer;
    double cpu = cpu_seconds();
};

void report(const std::string& step, const Watch& watch)
{
    fmt::print("{:<36} {:7.2f} s {:7.2f} s CPU {:6.0f} MB peak\n", step, watch.timer.seconds(),
               cpu_seconds() - watch.cpu, static_cast<double>(used().ru_maxrss) * 1024e-6);
}

// Every task with the key that it would have if each result had the digest of its task's number.
std::size_t compute_keys(const std::vector<Task>& tasks)
{
    TaskKeys keys(tasks, {});
    std::size_t known = 0;
    for (std::size_t i = 0; i < tasks.size(); ++i) {
        std::map<std::string, std::string> outputs;
        for (const auto& output : tasks[i].outputs)
            outputs[output.port] = fmt::format("{:064x}", i);
        known += keys.key(i).has_value() ? 1 : 0;
        keys.set_outputs(i, std::move(outputs));
    }
    return known;
}

std::size_t run_through(const std::vector<Task>& tasks)
{
    ReadyQueue queue(tasks);
    std::size_t done = 0;
    while (!queue.ready().empty()) {
        const std::size_t task = *queue.ready().begin();
        queue.take(task);
        queue.done(task);
        ++done;
    }
    return done;
}

int plan(int argc, char** argv)
{
    const Watch all;
    Problems problems;
    const Pipeline pipeline = read_pipeline(find_yaml("pipelines", "indoor"), problems);
    Catalogue catalogue(stage_folder());
    const Graph graph = build_graph(pipeline, catalogue, std::move(problems));
    report("read and check the pipeline", all);
    const std::size_t scans = argc > 1 ? std::strtoul(argv[1], nullptr, 10) : kTasks / graph.nodes.size() + 1;
    std::vector<NamedScan> named;
    for (std::size_t i = 0; i < scans; ++i)
        named.push_back({fmt::format("scan{:05}", i), fmt::format("/data/scans/scan{:05}", i)});
    Watch step;
    auto tasks = plan_tasks(graph, named, {"/data/out", "/data/out/.store"}, {});
    report(fmt::format("make {} tasks", tasks.size()), step);
    step = Watch();
    wait_for_equal_tasks(tasks);
    report("find equal tasks", step);
    step = Watch();
    const std::size_t known = compute_keys(tasks);
    report(fmt::format("compute {} keys", known), step);
    step = Watch();
    const std::size_t done = run_through(tasks);
    report(fmt::format("order {} tasks", done), step);
    report("all", all);
    return done == tasks.size() ? 0 : 1;
}

} // namespace
} // namespace quoin

int main(int argc, char** argv)
{
    try {
        return quoin::plan(argc, argv);
    } catch (const quoin::Error& error) {
        fmt::print(stderr, "{}\n", error.what());
        return 1;
    }
}
