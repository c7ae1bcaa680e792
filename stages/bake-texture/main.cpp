#include "bake/bake_texture.h"

#include "schema/filled_schema.h"
#include "schema/schema.h"
#include "stage/stage.h"

#include <optional>

int main(int argc, char** argv)
{
    using namespace quoin;
    const Stage stage{
        .name = "bake-texture",
        .summary = "lays every plane flat on an atlas and gives it its final colours",
        .impl_version = 9,
        .inputs = {{"scan", "frames and cameras"},
                   {"keyframes", "the frames that colours come from"},
                   {"plane_mesh", "the planes to texture"},
                   {"alignment", "poses, planes and exposures of the keyframes"},
                   {"mesh", "dense mesh with vertex colours, for what no keyframe sees", true}},
        .outputs = {{"textured_mesh", "the planes with uv coordinates and atlas pages"}},
        .reads_images = true,
        .resources = {.memory = "bytes(plane_mesh) * 20 + bytes(mesh) * 4 + 1500M"},
    };
    return run_stage<BakeTextureParams>(stage, argc, argv, [](const StageRun& run, const BakeTextureParams& params) {
        const Scan scan = read_scan(run.in("scan"));
        const ScanImages images(scan, run.scan_root());
        const Keyframes keyframes = read_keyframes(run.in("keyframes"));
        const PlaneMesh planes = read_plane_mesh(run.in("plane_mesh"));
        const Alignment alignment = read_alignment(run.in("alignment"));
        const auto dense = run.has("mesh") ? std::optional(read_mesh(run.in("mesh"))) : std::nullopt;
        run.write("textured_mesh",
                  Filled<TexturedMesh>{
                      bake_texture({images, keyframes, planes, alignment, dense ? &*dense : nullptr}, params),
                      read_face_filled(run.in("plane_mesh"))});
    });
}
