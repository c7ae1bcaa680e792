#include "model/export_model.h"

#include "schema/schema.h"
#include "stage/stage.h"

#include <optional>

namespace {
using namespace quoin;

template <class T>
std::optional<T> read_if_given(const StageRun& run, const std::string& port, T (*read)(const std::filesystem::path&))
{
    return run.has(port) ? std::optional<T>(read(run.in(port))) : std::nullopt;
}

template <class T>
const T* pointer(const std::optional<T>& value)
{
    return value ? &*value : nullptr;
}

} // namespace

int main(int argc, char** argv)
{
    const Stage stage{
        .name = "export",
        .summary = "writes the model as GLB, OBJ and PLY with planes, trajectory and summary",
        .impl_version = 1,
        .inputs = {{"textured_mesh", "the model; else plane_mesh or mesh", true},
                   {"plane_mesh", "an untextured model", true},
                   {"mesh", "a model without planes", true},
                   {"scan", "times of the frames, and their poses where there is no alignment", true},
                   {"keyframes", "the frames of the alignment's poses", true},
                   {"alignment", "refined poses", true}},
        .outputs = {{"model", "folder of model.glb, model.obj, model.ply and their companions"}},
        .resources = {.memory = "bytes(textured_mesh) * 6 + bytes(plane_mesh) * 8 + bytes(mesh) * 8 + 200M"},
    };
    return run_stage<ExportParams>(stage, argc, argv, [](const StageRun& run, const ExportParams& params) {
        const auto textured = read_if_given(run, "textured_mesh", read_textured_mesh);
        const auto planes = read_if_given(run, "plane_mesh", read_plane_mesh);
        const auto mesh = read_if_given(run, "mesh", read_mesh);
        const auto scan = read_if_given(run, "scan", read_scan);
        const auto keyframes = read_if_given(run, "keyframes", read_keyframes);
        const auto alignment = read_if_given(run, "alignment", read_alignment);
        const ModelParts parts{pointer(textured),  pointer(planes),    pointer(mesh), pointer(scan),
                               pointer(keyframes), pointer(alignment), QUOIN_VERSION};
        run.write_folder("model", [&](const std::filesystem::path& folder) { export_model(parts, folder, params); });
    });
}
