// The command line of a verb. CLI11 does the work, in option_parser.cpp alone: it is slow to compile.
#pragma once

#include "quoin/verb.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
} // namespace CLI

namespace quoin {

class OptionParser {
public:
    // What may be said of an option after it was added.
    class Option {
    public:
        explicit Option(CLI::Option* option) : option_(option) {}
        Option& required();
        Option& show_default(); // in the help
        Option& one_of(const std::vector<std::string>& values);
        Option& positive();
        Option& not_negative();
        Option& comma_separated();

    private:
        CLI::Option* option_;
    };

    // `name` as a person types it: "quoin run".
    OptionParser(const std::string& description, const std::string& name);
    ~OptionParser();
    OptionParser(const OptionParser&) = delete;
    OptionParser& operator=(const OptionParser&) = delete;

    // `flags` as in "-S,--set"; without dashes it is a positional argument. What is bound has to outlive parse().
    template <class Value>
    Option option(const std::string& flags, Value& value, const std::string& doc);
    Option flag(const std::string& flags, bool& value, const std::string& doc);

    // An option that may be given several times, with one value each time.
    Option repeated(const std::string& flags, std::vector<std::string>& values, const std::string& doc);

    // Another text for an option that was added before.
    void describe(const std::string& flag, const std::string& doc);

    // False when there is nothing to do: the help was asked for and is printed, or `--list-options`, of which
    // completion and reference pages are made. Throws UsageError when something is wrong.
    bool parse(const Arguments& arguments);

private:
    std::unique_ptr<CLI::App> app_;
};

extern template OptionParser::Option OptionParser::option(const std::string&, std::string&, const std::string&);
extern template OptionParser::Option OptionParser::option(const std::string&, std::vector<std::string>&,
                                                          const std::string&);
extern template OptionParser::Option OptionParser::option(const std::string&, int&, const std::string&);
extern template OptionParser::Option OptionParser::option(const std::string&, std::size_t&, const std::string&);
extern template OptionParser::Option OptionParser::option(const std::string&, std::optional<int>&, const std::string&);
extern template OptionParser::Option OptionParser::option(const std::string&, std::vector<int>&, const std::string&);

} // namespace quoin
