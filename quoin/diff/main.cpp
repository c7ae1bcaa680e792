// `quoin diff A B`: two artifacts, or two folders of results.
#include "base/error.h"
#include "compare/compare.h"
#include "quoin/diff/run_diff.h"
#include "quoin/option_parser.h"

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
    try {
        quoin::OptionParser parser(
            "compares two artifacts, or the results of two runs; exit code 0 when they are equal, 1 when not",
            "quoin diff");
        std::string first, second;
        parser.option("A", first, "an artifact, or OUT/<scan> of a run").required();
        parser.option("B", second, "another").required();
        if (!parser.parse(quoin::Arguments(argv + 1, argv + argc))) return 0;
        return quoin::diff(first, second);
    } catch (const quoin::Error& error) {
        fmt::print(stderr, "{}\n", error.what());
        return static_cast<int>(error.code());
    } catch (const std::exception& error) {
        fmt::print(stderr, "quoin diff: internal error: {}\n", error.what());
        return static_cast<int>(quoin::ExitCode::Impossible);
    }
}
