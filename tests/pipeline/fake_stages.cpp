#include "pipeline/fake_stages.h"

#include "artifact/artifact.h"
#include "support/file_text.h"

#include <fstream>

namespace quoin::test {
namespace fs = std::filesystem;
namespace {

struct FakePort {
    std::string name, schema, version = "1";
    bool is_optional = false;
};

FakePort parse_port(std::string text)
{
    FakePort port;
    port.is_optional = text.starts_with('?');
    if (port.is_optional) text.erase(0, 1);
    const auto colon = text.find(':');
    port.name = port.schema = text.substr(0, colon);
    if (colon == std::string::npos) return port;
    const auto slash = text.find('/');
    port.schema = text.substr(colon + 1, slash - colon - 1);
    port.version = text.substr(slash + 1);
    return port;
}

std::string port_json(const std::string& text)
{
    const FakePort port = parse_port(text);
    return R"({"port":")" + port.name + R"(","schema":")" + port.schema + R"(","version":)" + port.version +
           R"(,"optional":)" + (port.is_optional ? "true" : "false") + R"(,"doc":""})";
}

// What the stage puts into its output's place.
void write_sample(const fs::path& folder, const std::string& stage, const FakePort& port)
{
    if (port.schema == "folder" || port.schema == "model") return;
    Artifact artifact;
    artifact.schema = port.schema;
    artifact.schema_version = std::stoi(port.version);
    artifact.add_text("made_by", stage);
    write_artifact(folder / (stage + "." + port.name + ".artifact"), artifact);
}

std::string ports_json(const std::vector<std::string>& ports)
{
    std::string text;
    for (const auto& port : ports)
        text += (text.empty() ? "" : ",") + port_json(port);
    return "[" + text + "]";
}

constexpr const char* kParams = R"([
 {"name":"size","type":"float","default":0.5,"unit":"m","min":0.0,"max":1.0,"doc":""},
 {"name":"count","type":"int","default":3,"unit":"","min":0,"doc":""},
 {"name":"mode","type":"choice","default":"fast","choices":["fast","exact"],"unit":"","doc":""},
 {"name":"flag","type":"bool","default":false,"unit":"","doc":""}])";

std::string script(const FakeStage& stage)
{
    const std::string name = stage.name;
    return "#!/bin/bash\nhere=$(dirname \"$0\")\n"
           "if [ \"$1\" = --describe ]; then cat <<'JSON'\n"
           R"({"name":")" +
           name + R"(","summary":"","impl_version":1,"inputs":)" + ports_json(stage.inputs) + R"(,"outputs":)" +
           ports_json(stage.outputs) + R"(,"params":)" + kParams +
           "}\nJSON\nexit 0; fi\n"
           "echo start " +
           name +
           " >> $here/log\n"
           "echo \"$@\" > $here/" +
           name +
           ".arguments\n"
           "outputs=(); record=; while [ $# -gt 0 ]; do case $1 in --out) outputs+=(\"$2\");; --record) "
           "record=$2;; esac; shift 2; done\n" +
           stage.body +
           "\n"
           "for output in \"${outputs[@]}\"; do sample=$here/" +
           name +
           ".${output%%=*}.artifact; place=${output#*=}\n"
           "if [ -e \"$sample\" ]; then cp \"$sample\" \"$place.tmp\"; mv -f \"$place.tmp\" \"$place\"; else mkdir -p "
           "\"$place\"; fi; done\n"
           R"(echo '{"stage":")" +
           name +
           R"(","cached":false,"seconds":1.5,"peak_memory_bytes":1000000}' > "$record")"
           "\n"
           "echo end " +
           name + " >> $here/log\n";
}

} // namespace

FakeStages::FakeStages(const std::vector<FakeStage>& stages)
{
    for (const auto& stage : stages) {
        const fs::path path = folder() / stage.name;
        std::ofstream(path) << script(stage);
        fs::permissions(path, fs::perms::owner_all);
        for (const auto& output : stage.outputs)
            write_sample(folder(), stage.name, parse_port(output));
    }
}

std::vector<std::string> FakeStages::log() const
{
    std::vector<std::string> lines;
    std::ifstream file(folder() / "log");
    for (std::string line; std::getline(file, line);)
        lines.push_back(line);
    return lines;
}

std::string FakeStages::arguments(const std::string& name) const { return file_text(folder() / (name + ".arguments")); }

} // namespace quoin::test
