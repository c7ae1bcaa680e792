#include "image/image_io.h"

#include "base/atomic_file.h"
#include "base/error.h"
#include "image/formats.h"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <sys/stat.h>
#include <unistd.h>

namespace quoin {
namespace fs = std::filesystem;
namespace {

using formats::Bytes, formats::check_complete, formats::refuse;

cv::Mat decode(Bytes bytes, const std::string& name, int flags)
{
    check_complete(bytes, name);
    cv::Mat image;
    try {
        const cv::Mat encoded(1, static_cast<int>(bytes.size()), CV_8U, const_cast<std::byte*>(bytes.data()));
        image = cv::imdecode(encoded, flags);
    } catch (const cv::Exception& error) {
        refuse(name, "cannot decode the image (" + error.err + ")", "a JPEG, PNG, BMP, TIFF or WebP file");
    }
    if (image.empty()) refuse(name, "not an image that can be decoded", "a JPEG, PNG, BMP, TIFF or WebP file");
    return image;
}

std::string kind_of(const cv::Mat& image)
{
    return fmt::format("an image of {} channel(s) of {} bits", image.channels(), 8 * image.elemSize1());
}

// Any 8-bit grey, BGR or BGRA picture as RGB.
cv::Mat as_rgb(const cv::Mat& image, const std::string& name)
{
    if (image.depth() != CV_8U || image.channels() == 2)
        refuse(name, kind_of(image), "a colour image of 8 bits a channel");
    cv::Mat rgb;
    const int channels = image.channels();
    cv::cvtColor(image, rgb,
                 channels == 1   ? cv::COLOR_GRAY2RGB
                 : channels == 3 ? cv::COLOR_BGR2RGB
                                 : cv::COLOR_BGRA2RGB);
    return rgb;
}

template <class Pixel>
Image<Pixel> copied(const cv::Mat& mat)
{
    Image<Pixel> image(mat.cols, mat.rows);
    const std::size_t row_bytes = static_cast<std::size_t>(mat.cols) * sizeof(Pixel);
    for (int y = 0; y < mat.rows; ++y)
        std::memcpy(image.row(y), mat.ptr(y), row_bytes);
    return image;
}

template <class Pixel>
cv::Mat viewed(const Image<Pixel>& image, int type)
{
    return cv::Mat(image.height, image.width, type, const_cast<Pixel*>(image.pixels.data()));
}

std::vector<std::byte> encode_png(const cv::Mat& image)
{
    if (image.empty()) throw ResourceError("cannot encode a PNG: the image has no pixels");
    std::vector<std::uint8_t> encoded;
    if (!cv::imencode(".png", image, encoded)) throw ResourceError("cannot encode a PNG");
    const auto bytes = std::as_bytes(std::span(encoded));
    return {bytes.begin(), bytes.end()};
}

} // namespace

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
    return copied<Rgb8>(as_rgb(decode(bytes, name, cv::IMREAD_UNCHANGED), name));
}

GrayImage decode_gray(Bytes bytes, const std::string& name, int reduction)
{
    const int flags = reduction == 4   ? cv::IMREAD_REDUCED_GRAYSCALE_4
                      : reduction == 2 ? cv::IMREAD_REDUCED_GRAYSCALE_2
                                       : cv::IMREAD_GRAYSCALE;
    const cv::Mat gray = decode(bytes, name, flags | cv::IMREAD_IGNORE_ORIENTATION);
    GrayImage image(gray.cols, gray.rows);
    cv::Mat target = viewed(image, CV_32F);
    gray.convertTo(target, CV_32F, 1.0 / 255.0);
    return image;
}

Image<std::uint16_t> decode_gray16(Bytes bytes, const std::string& name)
{
    const cv::Mat image = decode(bytes, name, cv::IMREAD_UNCHANGED);
    if (image.type() != CV_16U) refuse(name, kind_of(image), "one channel of 16 bits (a depth image)");
    return copied<std::uint16_t>(image);
}

std::vector<std::byte> encode_png(const ColorImage& image)
{
    cv::Mat bgr;
    if (!image.empty()) cv::cvtColor(viewed(image, CV_8UC3), bgr, cv::COLOR_RGB2BGR);
    return encode_png(bgr);
}

std::vector<std::byte> encode_png(const Image<std::uint8_t>& image) { return encode_png(viewed(image, CV_8U)); }

std::vector<std::byte> encode_png(const Image<std::uint16_t>& image) { return encode_png(viewed(image, CV_16U)); }

void write_png(const fs::path& path, const ColorImage& image) { write_atomically(path, encode_png(image)); }

} // namespace quoin
