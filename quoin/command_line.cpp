#include "quoin/command_line.h"

#include "base/error.h"
#include "pipeline/source.h"

#include <algorithm>
#include <fmt/format.h>

namespace quoin {
namespace {

// The first argument that looks like an option and is none, with the nearest that there is.
std::string unknown_option(const CLI::App& app, const Arguments& arguments)
{
    std::vector<std::string> known;
    for (const CLI::Option* option : app.get_options())
        for (const auto& name : option->get_lnames())
            known.push_back("--" + name);
    for (const auto& argument : arguments) {
        const std::string name = argument.substr(0, argument.find('='));
        if (name.starts_with("--") && std::ranges::find(known, name) == known.end())
            return fmt::format("there is no option '{}'{}", name, hint(name, known));
    }
    return {};
}

// What reference pages and completion are made of (emit/command_help.h).
void list_options(const CLI::App& app)
{
    fmt::print("{}\n", app.get_description());
    for (const CLI::Option* option : app.get_options())
        fmt::print("{}\t{}\n", option->get_name(option->get_positional(), !option->get_positional()),
                   option->get_description());
}

} // namespace

bool parse_arguments(CLI::App& app, const Arguments& arguments)
{
    if (arguments == Arguments{"--list-options"}) {
        list_options(app);
        return false;
    }
    try {
        app.parse(Arguments(arguments.rbegin(), arguments.rend())); // CLI11 takes them from the back
        return true;
    } catch (const CLI::CallForHelp&) {
        fmt::print("{}", app.help());
        return false;
    } catch (const CLI::ExtrasError& error) {
        const std::string unknown = unknown_option(app, arguments);
        throw UsageError(fmt::format("{}: {}", app.get_name(), unknown.empty() ? error.what() : unknown));
    } catch (const CLI::ParseError& error) {
        throw UsageError(fmt::format("{}: {}; see {} --help", app.get_name(), error.what(), app.get_name()));
    }
}

CLI::Option* add_repeated(CLI::App& app, const std::string& flags, std::vector<std::string>& values,
                          const std::string& doc)
{
    return app.add_option(flags, values, doc)
        ->expected(1)
        ->allow_extra_args(false)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

} // namespace quoin
