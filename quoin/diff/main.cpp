// `quoin diff A B`: two artifacts, or two folders of results.
#include "base/error.h"
#include "compare/compare.h"
#include "quoin/diff/run_diff.h"

#include <CLI/CLI.hpp>
#include <filesystem>
#include <fmt/format.h>

namespace quoin {
namespace {

namespace fs = std::filesystem;

int diff(const fs::path& first, const fs::path& second)
{
    for (const auto& path : {first, second})
        if (!fs::exists(path)) throw InputError(fmt::format("{}: no such file or folder", path.string()));
    if (fs::is_directory(first) != fs::is_directory(second))
        throw UsageError("one is a file, the other a folder: name two artifacts, or two folders OUT/<scan>");
    const Comparison comparison =
        fs::is_directory(first) ? compare_runs(first, second) : compare_artifacts(first, second);
    for (const auto& line : comparison.lines)
        fmt::print("{}\n", line);
    return comparison.is_equal ? 0 : 1;
}

} // namespace
} // namespace quoin

int main(int argc, char** argv)
{
    CLI::App app("compares two artifacts, or the results of two runs; exit code 0 when they are equal, 1 when not",
                 "quoin diff");
    std::string first, second;
    app.add_option("A", first, "an artifact, or OUT/<scan> of a run")->required();
    app.add_option("B", second, "another")->required();
    try {
        app.parse(argc, argv);
        return quoin::diff(first, second);
    } catch (const CLI::CallForHelp&) {
        fmt::print("{}", app.help());
        return 0;
    } catch (const CLI::ParseError& error) {
        fmt::print(stderr, "quoin diff: {}; see quoin diff --help\n", error.what());
        return static_cast<int>(quoin::ExitCode::Usage);
    } catch (const quoin::Error& error) {
        fmt::print(stderr, "{}\n", error.what());
        return static_cast<int>(error.code());
    } catch (const std::exception& error) {
        fmt::print(stderr, "quoin diff: internal error: {}\n", error.what());
        return static_cast<int>(quoin::ExitCode::Impossible);
    }
}
