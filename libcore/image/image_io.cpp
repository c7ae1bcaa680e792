#include "image/image_io.h"

#include "base/atomic_file.h"
#include "base/error.h"
#include "image/jpeg.h"
#include "image/other_formats.h"
#include "image/png.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <opencv2/imgproc.hpp>
#include <sys/stat.h>
#include <unistd.h>

namespace quoin {
namespace fs = std::filesystem;
namespace {

using formats::Bytes, formats::check_complete, formats::refuse;

// Half or a quarter of the size, as libjpeg does while it decodes; other formats know nothing of the kind.
formats::Raster reduced(formats::Raster raster, int reduction)
{
    if (reduction == 1) return raster;
    formats::Raster small{raster.width / reduction, raster.height / reduction, raster.channels, raster.bits, {}};
    small.allocate();
    const cv::Mat from(raster.height, raster.width, CV_8UC(raster.channels), raster.bytes.data());
    cv::Mat to(small.height, small.width, CV_8UC(small.channels), small.bytes.data());
    cv::resize(from, to, to.size(), 0, 0, cv::INTER_LINEAR_EXACT);
    return small;
}

formats::Raster decode(Bytes bytes, const std::string& name, const formats::Request& request)
{
    check_complete(bytes, name);
    if (formats::is_png(bytes)) return reduced(formats::decode_png(bytes, name, request), request.reduction);
    if (formats::is_jpeg(bytes))
        if (auto raster = formats::decode_jpeg(bytes, name, request)) return *std::move(raster);
    return reduced(formats::decode_other(bytes, name, request), request.reduction);
}

std::string kind_of(const formats::Raster& raster)
{
    return fmt::format("an image of {} channel(s) of {} bits", raster.channels, raster.bits);
}

template <class Pixel>
Image<Pixel> copied(const formats::Raster& raster)
{
    Image<Pixel> image(raster.width, raster.height);
    std::memcpy(image.pixels.data(), raster.bytes.data(), raster.bytes.size());
    return image;
}

ColorImage as_color(const formats::Raster& raster)
{
    if (raster.channels == 3) return copied<Rgb8>(raster);
    ColorImage image(raster.width, raster.height);
    std::ranges::transform(raster.bytes, image.pixels.begin(), [](std::uint8_t v) { return Rgb8{v, v, v}; });
    return image;
}

} // namespace

ImageInfo inspect_image(Bytes bytes, const std::string& name)
{
    check_complete(bytes, name);
    if (formats::is_png(bytes)) return formats::png_info(bytes, name);
    if (formats::is_jpeg(bytes)) return formats::jpeg_info(bytes, name);
    return formats::inspect_other(bytes, name);
}

std::vector<std::byte> read_bytes(const fs::path& path)
{
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    const auto fail = [&](int error) {
        if (descriptor >= 0) ::close(descriptor);
        throw InputError(fmt::format("{}: cannot read the file: {}", path.string(), std::strerror(error)));
    };
    struct stat status {};
    if (descriptor < 0 || ::fstat(descriptor, &status) != 0) fail(errno);
    if (S_ISDIR(status.st_mode)) fail(EISDIR);
    std::vector<std::byte> bytes(static_cast<std::size_t>(status.st_size));
    for (std::size_t done = 0; done < bytes.size();) {
        const ssize_t got = ::read(descriptor, bytes.data() + done, bytes.size() - done);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) fail(errno);
        if (got == 0) bytes.resize(done); // it became shorter meanwhile
        done += static_cast<std::size_t>(got);
    }
    ::close(descriptor);
    return bytes;
}

ColorImage read_color(const fs::path& path) { return decode_color(read_bytes(path), path.string()); }

Image<std::uint16_t> read_gray16(const fs::path& path) { return decode_gray16(read_bytes(path), path.string()); }

ColorImage decode_color(Bytes bytes, const std::string& name)
{
    const formats::Raster raster = decode(bytes, name, {});
    if (raster.bits != 8) refuse(name, kind_of(raster), "a colour image of 8 bits a channel");
    return as_color(raster);
}

GrayImage decode_gray(Bytes bytes, const std::string& name, int reduction)
{
    const formats::Raster raster = decode(bytes, name, {true, reduction});
    GrayImage image(raster.width, raster.height);
    constexpr float kUnit = 1.0f / 255.0f;
    std::ranges::transform(raster.bytes, image.pixels.begin(),
                           [](std::uint8_t v) { return kUnit * static_cast<float>(v); });
    return image;
}

Image<std::uint16_t> decode_gray16(Bytes bytes, const std::string& name)
{
    const formats::Raster raster = decode(bytes, name, {});
    if (raster.bits != 16 || raster.channels != 1)
        refuse(name, kind_of(raster), "one channel of 16 bits (a depth image)");
    return copied<std::uint16_t>(raster);
}

void write_png(const fs::path& path, const ColorImage& image) { write_atomically(path, encode_png(image)); }

} // namespace quoin
