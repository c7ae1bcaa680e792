#include "image/png.h"

#include "base/error.h"

#include <bit>
#include <csetjmp>
#include <cstring>
#include <fmt/format.h>
#include <png.h>
#include <zlib.h>

namespace quoin {
namespace {

static_assert(std::endian::native == std::endian::little, "PNG keeps the high byte of 16 bits first");

// libpng reports by a function that must not return: back to where the call began, with the words kept.
struct PngFailure {
    std::jmp_buf place;
    char words[256] = {};
};

[[noreturn]] void fail(png_structp png, png_const_charp words)
{
    auto* failure = static_cast<PngFailure*>(png_get_error_ptr(png));
    std::strncpy(failure->words, words, sizeof(failure->words) - 1);
    std::longjmp(failure->place, 1);
}

void ignore(png_structp, png_const_charp) {} // warnings: who reads photographs cannot act on them

// Whether the calls to libpng in `step` went well; `step` holds nothing that has to be destroyed.
template <class Step>
bool succeeds(PngFailure& failure, const Step& step)
{
    if (setjmp(failure.place) != 0) return false;
    step();
    return true;
}

struct PngDecompressor {
    png_structp png;
    png_infop info;

    explicit PngDecompressor(PngFailure& failure)
        : png(png_create_read_struct(PNG_LIBPNG_VER_STRING, &failure, fail, ignore)),
          info(png ? png_create_info_struct(png) : nullptr)
    {
    }
    PngDecompressor(const PngDecompressor&) = delete;
    PngDecompressor& operator=(const PngDecompressor&) = delete;
    ~PngDecompressor() { png_destroy_read_struct(&png, &info, nullptr); }
};

class PngReader {
public:
    PngReader(formats::Bytes bytes, const std::string& name) : rest_(bytes), name_(name), codec_(failure_)
    {
        if (!codec_.info) throw ResourceError("no memory for decoding a PNG");
        png_set_read_fn(png(), this, read);
        run([&] { png_read_info(png(), info()); });
    }
    PngReader(const PngReader&) = delete;
    PngReader& operator=(const PngReader&) = delete;

    template <class Step>
    void run(const Step& step)
    {
        if (!succeeds(failure_, step)) formats::refuse_undecodable(name_, failure_.words);
    }

    png_structp png() const { return codec_.png; }
    png_infop info() const { return codec_.info; }
    int width() const { return static_cast<int>(png_get_image_width(png(), info())); }
    int height() const { return static_cast<int>(png_get_image_height(png(), info())); }
    int bits() const { return png_get_bit_depth(png(), info()); }
    int type() const { return png_get_color_type(png(), info()); }
    bool has_color() const { return (type() & PNG_COLOR_MASK_COLOR) != 0; }
    bool has_alpha() const
    {
        return (type() & PNG_COLOR_MASK_ALPHA) != 0 || png_get_valid(png(), info(), PNG_INFO_tRNS) != 0;
    }

private:
    static void read(png_structp png, png_bytep target, std::size_t count)
    {
        auto& rest = static_cast<PngReader*>(png_get_io_ptr(png))->rest_;
        if (count > rest.size()) png_error(png, "it ends too early");
        std::memcpy(target, rest.data(), count);
        rest = rest.subspan(count);
    }

    formats::Bytes rest_; // what is not read yet
    const std::string& name_;
    PngFailure failure_;
    PngDecompressor codec_;
};

// What libpng does to each row on the way: to grey or RGB, without alpha, 8 or 16 bits.
void choose_transforms(const PngReader& reader, bool is_gray, bool is_narrow)
{
    constexpr double kRed = 0.299, kGreen = 0.587; // Rec. 601 luma, as libjpeg's
    constexpr int kSilently = 1;
    png_structp png = reader.png();
    if (is_narrow)
        png_set_strip_16(png);
    else
        png_set_swap(png);
    png_set_strip_alpha(png);
    if (reader.type() == PNG_COLOR_TYPE_PALETTE) png_set_palette_to_rgb(png);
    if (!reader.has_color() && reader.bits() < 8) png_set_expand_gray_1_2_4_to_8(png);
    if (is_gray && reader.has_color()) png_set_rgb_to_gray(png, kSilently, kRed, kGreen);
    png_set_interlace_handling(png);
    png_read_update_info(png, reader.info());
}

// Pixels to be written: rows without gaps.
struct View {
    int width, height; // [px]
    int channels;      // 1 or 3
    int bits;          // a channel: 8 or 16
    const std::uint8_t* pixels;
};

void append(png_structp png, png_bytep bytes, std::size_t count)
{
    auto* file = static_cast<std::vector<std::byte>*>(png_get_io_ptr(png));
    const auto* first = reinterpret_cast<const std::byte*>(bytes);
    file->insert(file->end(), first, first + count);
}

void write_rows(png_structp png, png_infop info, const View& view)
{
    // Fast to write: runs of equal differences to the left are all that is looked for.
    png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_SUB);
    png_set_compression_level(png, Z_BEST_SPEED);
    png_set_compression_strategy(png, Z_RLE);
    png_set_IHDR(png, info, static_cast<png_uint_32>(view.width), static_cast<png_uint_32>(view.height), view.bits,
                 view.channels == 1 ? PNG_COLOR_TYPE_GRAY : PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_write_info(png, info);
    if (view.bits == 16) png_set_swap(png);
    const auto row_bytes = static_cast<std::size_t>(view.width * view.channels * (view.bits / 8));
    for (int y = 0; y < view.height; ++y)
        png_write_row(png, view.pixels + static_cast<std::size_t>(y) * row_bytes);
    png_write_end(png, info);
}

std::vector<std::byte> encode(const View& view)
{
    if (view.width <= 0 || view.height <= 0) throw ResourceError("cannot encode a PNG: the image has no pixels");
    std::vector<std::byte> file;
    PngFailure failure;
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &failure, fail, ignore);
    png_infop info = png ? png_create_info_struct(png) : nullptr;
    const bool is_written = info && succeeds(failure, [&] {
                                png_set_write_fn(png, &file, append, nullptr);
                                write_rows(png, info, view);
                            });
    png_destroy_write_struct(&png, &info);
    if (!is_written) throw ResourceError(fmt::format("cannot encode a PNG: {}", failure.words));
    return file;
}

template <class Pixel>
const std::uint8_t* bytes_of(const Image<Pixel>& image)
{
    return reinterpret_cast<const std::uint8_t*>(image.pixels.data());
}

} // namespace

namespace formats {

ImageInfo png_info(Bytes bytes, const std::string& name)
{
    const PngReader reader(bytes, name);
    return {reader.width(), reader.height(), (reader.has_color() ? 3 : 1) + (reader.has_alpha() ? 1 : 0),
            std::max(8, reader.bits())};
}

Raster decode_png(Bytes bytes, const std::string& name, const Request& request)
{
    PngReader reader(bytes, name);
    const bool is_gray = request.as_gray || !reader.has_color();
    const bool is_narrow = request.as_gray || reader.bits() <= 8;
    Raster raster{reader.width(), reader.height(), is_gray ? 1 : 3, is_narrow ? 8 : 16, {}};
    raster.allocate();
    std::vector<png_bytep> rows;
    for (int y = 0; y < raster.height; ++y)
        rows.push_back(raster.row(y));
    reader.run([&] {
        choose_transforms(reader, is_gray, is_narrow);
        png_read_image(reader.png(), rows.data());
    });
    return raster;
}

} // namespace formats

std::vector<std::byte> encode_png(const ColorImage& image)
{
    return encode({image.width, image.height, 3, 8, bytes_of(image)});
}

std::vector<std::byte> encode_png(const Image<std::uint8_t>& image)
{
    return encode({image.width, image.height, 1, 8, bytes_of(image)});
}

std::vector<std::byte> encode_png(const Image<std::uint16_t>& image)
{
    return encode({image.width, image.height, 1, 16, bytes_of(image)});
}

} // namespace quoin
