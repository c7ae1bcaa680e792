// Pictures to judge a model by: for every frame asked for, the photograph, the textured model from the same place, its
// planes in random colours, and its wireframe, side by side.
//
//     render_views SCAN.safetensors SCAN_ROOT TEXTURED_MESH.safetensors OUT.png FRAME...
#include "base/error.h"
#include "image/image_io.h"
#include "render/textured.h"
#include "schema/schema.h"

#include <cstdio>
#include <cstdlib>
#include <string>

namespace {

using namespace quoin;

Rgb8 color_of(std::uint32_t id)
{
    std::uint32_t h = id * 2654435761u;
    h ^= h >> 15;
    h *= 2246822519u;
    return {static_cast<std::uint8_t>(64 + (h & 127)), static_cast<std::uint8_t>(64 + ((h >> 8) & 127)),
            static_cast<std::uint8_t>(64 + ((h >> 16) & 127))};
}

ColorImage planes_of(const RenderedView& view, const PlaneMesh& mesh)
{
    ColorImage image(view.face.width, view.face.height);
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
        if (view.face.pixels[i] != kNoFace) image.pixels[i] = color_of(mesh.face_plane[view.face.pixels[i]]);
    return image;
}

// Light planes with a dark line wherever two faces meet.
ColorImage wireframe_of(const RenderedView& view, const PlaneMesh& mesh)
{
    ColorImage image = planes_of(view, mesh);
    for (auto& pixel : image.pixels)
        for (auto& channel : pixel)
            channel = static_cast<std::uint8_t>(channel == 0 ? 0 : 128 + channel / 2);
    for (int y = 0; y + 1 < image.height; ++y)
        for (int x = 0; x + 1 < image.width; ++x)
            if (view.face.at(x, y) != view.face.at(x + 1, y) || view.face.at(x, y) != view.face.at(x, y + 1))
                image.at(x, y) = {0, 0, 0};
    return image;
}

void paste(ColorImage& sheet, const ColorImage& image, int x0, int y0)
{
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            sheet.at(x0 + x, y0 + y) = image.at(x, y);
}

void render_sheet(const std::vector<std::string>& arguments)
{
    const Scan scan = read_scan(arguments[0]);
    const ScanImages images(scan, arguments[1]);
    const TexturedMesh mesh = read_textured_mesh(arguments[2]);
    const TexturedModel model(mesh);
    const int w = scan.color.width, h = scan.color.height, rows = static_cast<int>(arguments.size()) - 4;
    ColorImage sheet(4 * w, rows * h);
    for (int row = 0; row < rows; ++row) {
        const auto id = static_cast<FrameId>(std::stoul(arguments[static_cast<std::size_t>(row) + 4]));
        if (id >= scan.frames.size())
            throw UsageError("frame " + std::to_string(id) + ": the scan has " + std::to_string(scan.frames.size()));
        const RenderedView view = render_textured(model, scan.color, scan.color_from_world(id), 2);
        paste(sheet, images.color(id), 0, row * h);
        paste(sheet, view.color, w, row * h);
        paste(sheet, planes_of(view, mesh.planes), 2 * w, row * h);
        paste(sheet, wireframe_of(view, mesh.planes), 3 * w, row * h);
    }
    write_png(arguments[3], sheet);
}

} // namespace

int main(int argc, char** argv)
{
    const std::vector<std::string> arguments(argv + 1, argv + argc);
    if (arguments.size() < 5) {
        std::fputs("usage: render_views SCAN SCAN_ROOT TEXTURED_MESH OUT.png FRAME...\n", stderr);
        return 2;
    }
    try {
        render_sheet(arguments);
    } catch (const quoin::Error& error) {
        std::fprintf(stderr, "render_views: %s\n", error.what());
        return static_cast<int>(error.code());
    }
    return 0;
}
