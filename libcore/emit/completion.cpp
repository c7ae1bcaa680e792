#include "emit/completion.h"

#include <fmt/format.h>

namespace quoin {
namespace {

using Words = std::vector<std::string>;

Words split(const std::string& flags)
{
    Words words;
    std::size_t at = 0;
    for (std::size_t comma = flags.find(','); comma != std::string::npos; comma = flags.find(',', at)) {
        words.push_back(flags.substr(at, comma - at));
        at = comma + 1;
    }
    words.push_back(flags.substr(at));
    return words;
}

// The flags of a verb and, for `emit`, its formats.
Words options_of(const VerbHelp& verb)
{
    Words options;
    for (const auto& option : verb.options)
        for (const auto& flag : split(option.flags))
            if (flag.starts_with("--") || verb.name == "emit") options.push_back(flag);
    options.emplace_back("--help");
    return options;
}

const Words& stage_options()
{
    static const Words options{"--in",        "--out",    "--set",      "--config", "--scan-root",
                               "--threads",   "--memory", "--progress", "--cache",  "--store",
                               "--log-level", "--record", "--describe", "--key",    "--help"};
    return options;
}

// "max_angle=", or "method=heap", "method=hybrid" where there is a choice.
Words settings_of(const StageDescription& stage, const std::string& prefix)
{
    Words settings;
    for (const auto& spec : stage.params) {
        Words values = spec.choices;
        if (spec.type == ParamType::Bool) values = {"true", "false"};
        if (values.empty()) values = {""};
        for (const auto& value : values)
            settings.push_back(fmt::format("{}{}={}", prefix, spec.name, value));
    }
    return settings;
}

Words ports_of(const std::vector<PortDescription>& ports)
{
    Words words;
    for (const auto& port : ports)
        words.push_back(port.name + "=");
    return words;
}

// "[run]='--scan --out'" lines of an associative array.
std::string entry(const std::string& key, const Words& words)
{
    return fmt::format("    [{}]='{}'\n", key, fmt::join(words, " "));
}

// The words of every context, in arrays that both shells understand.
std::string tables(const CommandHelp& help)
{
    Words stages;
    std::string options, settings, inputs, outputs;
    Words all_settings;
    for (const auto& verb : help.verbs)
        options += entry(verb.name, options_of(verb));
    for (const auto& stage : help.stages) {
        stages.push_back(stage.name);
        options += entry(stage.name, stage_options());
        settings += entry(stage.name, settings_of(stage, ""));
        inputs += entry(stage.name, ports_of(stage.inputs));
        outputs += entry(stage.name, ports_of(stage.outputs));
        for (const auto& setting : settings_of(stage, stage.name + "."))
            all_settings.push_back(setting);
    }
    return fmt::format("_quoin_stages='{}'\n_quoin_settings='{}'\ntypeset -gA _quoin_options=(\n{})\n"
                       "typeset -gA _quoin_stage_settings=(\n{})\ntypeset -gA _quoin_inputs=(\n{})\n"
                       "typeset -gA _quoin_outputs=(\n{})\n\n",
                       fmt::join(stages, " "), fmt::join(all_settings, " "), options, settings, inputs, outputs);
}

// The words that can stand after $2, the word before the cursor, of the verb or stage $1. Both shells run it.
constexpr const char* kChoose =
    R"sh(# The words that may follow the option $2 of the verb or stage $1; none means files.
_quoin_words() {
    case $2 in
    -S | --set) echo "${_quoin_stage_settings[$1]:-$_quoin_settings}" ;;
    --in) echo "${_quoin_inputs[$1]:-}" ;;
    --out) echo "${_quoin_outputs[$1]:-}" ;;
    --from | --until | --force) echo "$_quoin_stages" ;;
    --use) echo "$_quoin_stages" | sed 's/\([^ ][^ ]*\)/\1=/g' ;;
    --cache) echo auto off only ;;
    --progress) echo auto bar json none ;;
    --log-level) echo debug info warning error off ;;
    --mode) echo stages chain ;;
    esac
}

)sh";

} // namespace

std::string bash_completion(const CommandHelp& help)
{
    std::string text = tables(help);
    for (std::size_t at = text.find("typeset -gA"); at != std::string::npos; at = text.find("typeset -gA", at))
        text.replace(at, 11, "declare -gA");
    return "# Completion of quoin for bash, written by `quoin emit completion bash`.\n" + text + kChoose +
           R"sh(_quoin() {
    local verb=${COMP_WORDS[1]} word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} words
    if [ "$COMP_CWORD" -eq 1 ]; then
        words=${!_quoin_options[*]}
    elif [ "$verb" = emit ] && [ "$COMP_CWORD" -eq 2 ] || [[ $word == -* ]]; then
        words=${_quoin_options[$verb]:-}
    elif [ "$verb" = describe ] || [ "$verb" = stage-check ]; then
        words=$_quoin_stages
    else
        words=$(_quoin_words "$verb" "$before")
    fi
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")
    [[ ${COMPREPLY[0]:-} != *= ]] || compopt -o nospace
}
complete -o default -F _quoin quoin
)sh";
}

std::string zsh_completion(const CommandHelp& help)
{
    return "#compdef quoin\n# Completion of quoin for zsh, written by `quoin emit completion zsh`.\n" + tables(help) +
           kChoose + R"sh(_quoin() {
    local verb=${words[2]} word=${words[CURRENT]} before=${words[CURRENT-1]} found
    if (( CURRENT == 2 )); then
        found="${(k)_quoin_options}"
    elif [[ $verb == emit && $CURRENT -eq 3 || $word == -* ]]; then
        found=${_quoin_options[$verb]:-}
    elif [[ $verb == describe || $verb == stage-check ]]; then
        found=$_quoin_stages
    else
        found=$(_quoin_words "$verb" "$before")
    fi
    if [[ -z $found ]]; then
        _files
    elif [[ $found == *= || $found == *=\ * ]]; then
        compadd -S '' -- ${=found}
    else
        compadd -- ${=found}
    fi
}
if [[ ${funcstack[1]} == _quoin ]]; then _quoin "$@"; fi
)sh";
}

} // namespace quoin
