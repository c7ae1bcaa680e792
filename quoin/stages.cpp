#include "pipeline/catalogue.h"
#include "pipeline/locate.h"
#include "quoin/option_parser.h"

#include <fmt/format.h>

namespace quoin {

int stages_verb(const Arguments& arguments)
{
    OptionParser parser("lists the stages that there are", "quoin stages");
    if (!parser.parse(arguments)) return 0;
    const std::filesystem::path folder = stage_folder();
    Catalogue catalogue(folder);
    for (const auto& name : catalogue.names()) {
        const StageDescription& stage = catalogue.describe(folder / name).description;
        fmt::print("{:<18} {}\n", name, stage.summary);
        fmt::print("{:<18}   {} -> {}\n", "", fmt::join(port_names(stage.inputs), ", "),
                   fmt::join(port_names(stage.outputs), ", "));
    }
    return 0;
}

} // namespace quoin
