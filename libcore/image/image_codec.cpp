// The part of image_io.h that needs OpenImageIO. It is a file of its own so that programs that only decode do not load
// that library and all that comes with it (0.2 s at every start).
#include "base/error.h"
#include "image/formats.h"
#include "image/image_io.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

namespace quoin {

ImageInfo inspect_image(std::span<const std::byte> bytes, const std::string& name)
{
    formats::check_complete(bytes, name);
    OIIO::Filesystem::IOMemReader reader(const_cast<std::byte*>(bytes.data()), bytes.size());
    const auto input = OIIO::ImageInput::open(formats::is_jpeg(bytes)  ? "bytes.jpg"
                                              : formats::is_png(bytes) ? "bytes.png"
                                                                       : name,
                                              nullptr, &reader);
    if (!input) {
        OIIO::geterror(); // fetched, or it is printed at exit
        formats::refuse(name, "not an image that can be decoded", "a JPEG, PNG, BMP, TIFF or WebP file");
    }
    const OIIO::ImageSpec& spec = input->spec();
    return {spec.width, spec.height, spec.nchannels, static_cast<int>(8 * spec.format.basesize())};
}

std::vector<std::byte> encode_jpeg(const ColorImage& image, int quality)
{
    if (image.empty()) throw ResourceError("cannot encode a JPEG: the image has no pixels");
    std::vector<unsigned char> encoded;
    OIIO::Filesystem::IOVecOutput buffer(encoded);
    OIIO::ImageSpec spec(image.width, image.height, 3, OIIO::TypeDesc::UINT8);
    spec["jpeg:subsampling"] = "4:4:4"; // edges of saturated colours stay sharp
    spec["Compression"] = fmt::format("jpeg:{}", quality);
    const auto output = OIIO::ImageOutput::create("bytes.jpg");
    const bool written = output && output->set_ioproxy(&buffer) && output->open("bytes.jpg", spec) &&
                         output->write_image(OIIO::TypeDesc::UINT8, image.pixels.data()) && output->close();
    if (!written) throw ResourceError("cannot encode a JPEG: " + (output ? output->geterror() : OIIO::geterror()));
    const auto bytes = std::as_bytes(std::span(encoded));
    return {bytes.begin(), bytes.end()};
}

} // namespace quoin
