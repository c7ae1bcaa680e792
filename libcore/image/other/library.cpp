#include "image/other/library.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace quoin::formats {
namespace {

constexpr const char* kNoImage = "not an image that can be decoded";

// Grey or RGB of any picture in OpenCV's order of channels.
cv::Mat without_alpha(const cv::Mat& image)
{
    cv::Mat result = image;
    if (image.channels() == 3) cv::cvtColor(image, result, cv::COLOR_BGR2RGB);
    if (image.channels() == 4) cv::cvtColor(image, result, cv::COLOR_BGRA2RGB);
    return result;
}

Raster as_raster(const cv::Mat& image)
{
    Raster raster{image.cols, image.rows, image.channels(), static_cast<int>(8 * image.elemSize1()), {}};
    raster.allocate();
    for (int y = 0; y < raster.height; ++y)
        std::copy_n(image.ptr(y), raster.row_bytes(), raster.row(y));
    return raster;
}

std::string decode(Bytes bytes, const Request& request, Raster& raster)
{
    const int flags =
        request.as_gray ? cv::IMREAD_GRAYSCALE | cv::IMREAD_IGNORE_ORIENTATION : int{cv::IMREAD_UNCHANGED};
    try {
        const cv::Mat encoded(1, static_cast<int>(bytes.size()), CV_8U, const_cast<std::byte*>(bytes.data()));
        const cv::Mat image = cv::imdecode(encoded, flags);
        if (image.empty()) return kNoImage;
        raster = as_raster(without_alpha(image));
        return {};
    } catch (const cv::Exception& error) {
        return "cannot decode the image (" + error.err + ")";
    }
}

std::string inspect(Bytes bytes, const std::string& name, ImageInfo& info)
{
    OIIO::Filesystem::IOMemReader reader(const_cast<std::byte*>(bytes.data()), bytes.size());
    const auto input = OIIO::ImageInput::open(name, nullptr, &reader);
    if (!input) {
        OIIO::geterror(); // fetched, or it is printed at exit
        return kNoImage;
    }
    const OIIO::ImageSpec& spec = input->spec();
    info = {spec.width, spec.height, spec.nchannels, static_cast<int>(8 * spec.format.basesize())};
    return {};
}

} // namespace
} // namespace quoin::formats

// NOLINTBEGIN(clang-diagnostic-return-type-c-linkage): C only for the names, by which they are looked up
extern "C" std::string quoin_inspect_image(quoin::formats::Bytes bytes, const std::string& name, quoin::ImageInfo& info)
{
    return quoin::formats::inspect(bytes, name, info);
}

extern "C" std::string quoin_decode_image(quoin::formats::Bytes bytes, const quoin::formats::Request& request,
                                          quoin::formats::Raster& raster)
{
    return quoin::formats::decode(bytes, request, raster);
}
// NOLINTEND(clang-diagnostic-return-type-c-linkage)
