#include "quoin/option_parser.h"

#include "base/error.h"
#include "pipeline/source.h"

#include <CLI/CLI.hpp>
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

OptionParser::Option& OptionParser::Option::required()
{
    option_->required();
    return *this;
}

OptionParser::Option& OptionParser::Option::show_default()
{
    option_->capture_default_str();
    return *this;
}

OptionParser::Option& OptionParser::Option::one_of(const std::vector<std::string>& values)
{
    option_->check(CLI::IsMember(values));
    return *this;
}

OptionParser::Option& OptionParser::Option::positive()
{
    option_->check(CLI::PositiveNumber);
    return *this;
}

OptionParser::Option& OptionParser::Option::not_negative()
{
    option_->check(CLI::NonNegativeNumber);
    return *this;
}

OptionParser::Option& OptionParser::Option::comma_separated()
{
    option_->delimiter(',');
    return *this;
}

OptionParser::OptionParser(const std::string& description, const std::string& name)
    : app_(std::make_unique<CLI::App>(description, name))
{
}

OptionParser::~OptionParser() = default;

template <class Value>
OptionParser::Option OptionParser::option(const std::string& flags, Value& value, const std::string& doc)
{
    return Option(app_->add_option(flags, value, doc));
}

template OptionParser::Option OptionParser::option(const std::string&, std::string&, const std::string&);
template OptionParser::Option OptionParser::option(const std::string&, std::vector<std::string>&, const std::string&);
template OptionParser::Option OptionParser::option(const std::string&, int&, const std::string&);
template OptionParser::Option OptionParser::option(const std::string&, std::size_t&, const std::string&);
template OptionParser::Option OptionParser::option(const std::string&, std::optional<int>&, const std::string&);
template OptionParser::Option OptionParser::option(const std::string&, std::vector<int>&, const std::string&);

OptionParser::Option OptionParser::flag(const std::string& flags, bool& value, const std::string& doc)
{
    return Option(app_->add_flag(flags, value, doc));
}

OptionParser::Option OptionParser::repeated(const std::string& flags, std::vector<std::string>& values,
                                            const std::string& doc)
{
    return Option(app_->add_option(flags, values, doc)
                      ->expected(1)
                      ->allow_extra_args(false)
                      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll));
}

void OptionParser::describe(const std::string& flag, const std::string& doc)
{
    app_->get_option(flag)->description(doc);
}

bool OptionParser::parse(const Arguments& arguments)
{
    if (arguments == Arguments{"--list-options"}) {
        list_options(*app_);
        return false;
    }
    try {
        app_->parse(Arguments(arguments.rbegin(), arguments.rend())); // CLI11 takes them from the back
        return true;
    } catch (const CLI::CallForHelp&) {
        fmt::print("{}", app_->help());
        return false;
    } catch (const CLI::ExtrasError& error) {
        const std::string unknown = unknown_option(*app_, arguments);
        throw UsageError(fmt::format("{}: {}", app_->get_name(), unknown.empty() ? error.what() : unknown));
    } catch (const CLI::ParseError& error) {
        throw UsageError(fmt::format("{}: {}; see {} --help", app_->get_name(), error.what(), app_->get_name()));
    }
}

} // namespace quoin
