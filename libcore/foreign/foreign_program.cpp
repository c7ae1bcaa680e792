#include "foreign/foreign_program.h"

#include "artifact/digest.h"
#include "base/error.h"
#include "pipeline/catalogue.h"
#include "pipeline/command_file.h"
#include "pipeline/locate.h"

#include <fmt/format.h>

namespace quoin {
namespace {

namespace fs = std::filesystem;

std::vector<Port> ports_of(const std::vector<PortDescription>& descriptions)
{
    std::vector<Port> ports;
    for (const auto& port : descriptions) {
        if (port.version != 1)
            throw UsageError(fmt::format("port '{}' is a {}/{}: this build reads and writes {}/1", port.name,
                                         port.schema, port.version, port.schema));
        ports.push_back({port.name, port.doc, port.optional, port.schema});
    }
    return ports;
}

// Names and contents of the files and the words of the command line; where they lie does not matter.
std::string implementation_of(const std::vector<fs::path>& code, const std::vector<std::string>& words)
{
    std::string text;
    for (const auto& file : code)
        text += fmt::format("{} {}\n", sha256_hex_of_file(file), file.filename().string());
    for (const auto& word : words)
        text += fmt::format("{}:{}\n", word.size(), word);
    return "foreign/" + sha256_hex(text);
}

ForeignProgram make_program(const StageDescription& description)
{
    ForeignProgram program;
    program.stage = {.name = description.name,
                     .summary = description.summary,
                     .impl_version = description.impl_version,
                     .inputs = ports_of(description.inputs),
                     .outputs = ports_of(description.outputs),
                     .reads_images = description.reads_images,
                     .resources = {},
                     .implementation = {}};
    program.params = description.params;
    return program;
}

} // namespace

ForeignProgram load_foreign_program(const std::string& use, const std::vector<fs::path>& more_code)
{
    if (is_command_file(use)) {
        Problems problems;
        CommandFile command = read_command_file(use, problems);
        problems.throw_if_any();
        ForeignProgram program = make_program(command.description);
        command.code.insert(command.code.end(), more_code.begin(), more_code.end());
        program.stage.implementation = implementation_of(command.code, command.words);
        program.words = command.exec;
        return program;
    }
    Catalogue catalogue(stage_folder());
    const Program& described = catalogue.describe(fs::absolute(use));
    ForeignProgram program = make_program(described.description);
    std::vector<fs::path> code = described.code;
    code.insert(code.end(), more_code.begin(), more_code.end());
    program.stage.implementation = implementation_of(code, {});
    program.words = {fs::absolute(use).string()};
    program.honours_contract = true;
    return program;
}

} // namespace quoin
