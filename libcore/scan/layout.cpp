#include "scan/layout.h"

#include "base/error.h"

#include <fmt/format.h>

namespace quoin {
namespace fs = std::filesystem;
namespace {

// From the most particular to the most general.
constexpr std::array kReaders{&kBundleFusionReader, &kSevenScenesReader, &kScannerAppReader, &kNumberedReader,
                              &kIclNuimReader,      &kTumReader,         &kRedwoodReader};

void check_folder(const fs::path& folder)
{
    if (!fs::exists(folder))
        throw InputError(folder.string() + ": there is no such folder; expected the folder of a scan");
    if (!fs::is_directory(folder)) throw InputError(folder.string() + ": not a folder; expected the folder of a scan");
    if (fs::is_empty(folder))
        throw InputError(folder.string() + ": the folder is empty; expected the folder of a scan");
}

std::string all_needs()
{
    std::string text;
    for (const LayoutReader* reader : kReaders)
        text += fmt::format("\n  {:13} {}: {}", choice_names(Layout{})[static_cast<std::size_t>(reader->layout)],
                            reader->title, reader->needs);
    return text;
}

} // namespace

const LayoutReader& find_layout(const fs::path& folder, Layout layout)
{
    check_folder(folder);
    for (const LayoutReader* reader : kReaders) {
        if (layout == Layout::Auto ? !reader->recognises(folder) : reader->layout != layout) continue;
        if (reader->recognises(folder)) return *reader;
        throw InputError(
            fmt::format("{}: not a scan in the {} layout, which needs {}; check the folder or --set layout=auto",
                        folder.string(), reader->title, reader->needs));
    }
    throw InputError(folder.string() +
                     ": the layout of the folder is not known. Layouts tried and what they need:" + all_needs());
}

} // namespace quoin
