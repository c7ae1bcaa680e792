#include "image/jpeg.h"

#include "base/error.h"

#include <array>
#include <csetjmp>
#include <cstdio>
#include <cstdlib>
#include <fmt/format.h>

#include <jpeglib.h> // needs FILE before it

namespace quoin {
namespace {

// libjpeg reports by a function that must not return: back to where the call began, with the words kept.
struct JpegFailure : jpeg_error_mgr {
    std::jmp_buf place;
    char words[JMSG_LENGTH_MAX] = {};

    JpegFailure()
    {
        jpeg_std_error(this);
        error_exit = [](j_common_ptr codec) {
            auto* failure = static_cast<JpegFailure*>(codec->err);
            failure->format_message(codec, failure->words);
            std::longjmp(failure->place, 1);
        };
        output_message = [](j_common_ptr) {}; // warnings: who reads photographs cannot act on them
    }
};

// Whether the calls to libjpeg in `step` went well; `step` holds nothing that has to be destroyed.
template <class Step>
bool succeeds(JpegFailure& failure, const Step& step)
{
    if (setjmp(failure.place) != 0) return false;
    step();
    return true;
}

struct JpegDecompressor : jpeg_decompress_struct {
    ~JpegDecompressor() { jpeg_destroy_decompress(this); }
};

class JpegReader {
public:
    JpegReader(formats::Bytes bytes, const std::string& name) : name_(name)
    {
        codec_.err = &failure_;
        run([&] {
            jpeg_create_decompress(&codec_);
            jpeg_mem_src(&codec_, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
            jpeg_read_header(&codec_, TRUE);
        });
    }
    JpegReader(const JpegReader&) = delete;
    JpegReader& operator=(const JpegReader&) = delete;

    template <class Step>
    void run(const Step& step)
    {
        if (!succeeds(failure_, step)) formats::refuse_undecodable(name_, failure_.words);
    }

    jpeg_decompress_struct& codec() { return codec_; }

private:
    const std::string& name_;
    JpegFailure failure_;
    JpegDecompressor codec_{};
};

class Writer {
public:
    Writer() { codec_.err = &failure_; }
    Writer(const Writer&) = delete;
    Writer& operator=(const Writer&) = delete;
    ~Writer()
    {
        jpeg_destroy_compress(&codec_);
        std::free(file_);
    }

    std::vector<std::byte> write(const ColorImage& image, int quality)
    {
        const bool is_written = succeeds(failure_, [&] {
            begin(image.width, image.height, quality);
            while (codec_.next_scanline < codec_.image_height) {
                const auto* row = reinterpret_cast<const JSAMPLE*>(image.row(static_cast<int>(codec_.next_scanline)));
                JSAMPROW rows[] = {const_cast<JSAMPROW>(row)};
                jpeg_write_scanlines(&codec_, rows, 1);
            }
            jpeg_finish_compress(&codec_);
        });
        if (!is_written) throw ResourceError(fmt::format("cannot encode a JPEG: {}", failure_.words));
        const auto* first = reinterpret_cast<const std::byte*>(file_);
        return {first, first + size_};
    }

private:
    void begin(int width, int height, int quality)
    {
        jpeg_create_compress(&codec_);
        jpeg_mem_dest(&codec_, &file_, &size_);
        codec_.image_width = static_cast<JDIMENSION>(width);
        codec_.image_height = static_cast<JDIMENSION>(height);
        codec_.input_components = 3;
        codec_.in_color_space = JCS_RGB;
        jpeg_set_defaults(&codec_);
        jpeg_set_quality(&codec_, quality, TRUE);
        for (int i = 0; i < codec_.num_components; ++i) // 4:4:4: edges of saturated colours stay sharp
            codec_.comp_info[i].h_samp_factor = codec_.comp_info[i].v_samp_factor = 1;
        jpeg_start_compress(&codec_, TRUE);
        // An Exif block without an entry, as OpenImageIO writes: the bytes of earlier results stay what they were.
        constexpr std::array<JOCTET, 20> kNoExif{'E', 'x', 'i', 'f', 0, 0, 'I', 'I', 0x2a, 0, 8};
        jpeg_write_marker(&codec_, JPEG_APP0 + 1, kNoExif.data(), kNoExif.size());
    }

    JpegFailure failure_;
    jpeg_compress_struct codec_{};
    unsigned char* file_ = nullptr; // malloc'ed by libjpeg
    unsigned long size_ = 0;
};

} // namespace

namespace formats {

ImageInfo jpeg_info(Bytes bytes, const std::string& name)
{
    JpegReader reader(bytes, name);
    const auto& header = reader.codec();
    return {static_cast<int>(header.image_width), static_cast<int>(header.image_height), header.num_components,
            header.data_precision};
}

std::optional<Raster> decode_jpeg(Bytes bytes, const std::string& name, const Request& request)
{
    JpegReader reader(bytes, name);
    auto& codec = reader.codec();
    if (codec.num_components != 1 && codec.num_components != 3) return std::nullopt;
    codec.scale_num = 1;
    codec.scale_denom = static_cast<unsigned>(request.reduction);
    const bool is_gray = request.as_gray || codec.num_components == 1;
    codec.out_color_space = is_gray ? JCS_GRAYSCALE : JCS_RGB;
    reader.run([&] { jpeg_start_decompress(&codec); });
    Raster raster{static_cast<int>(codec.output_width), static_cast<int>(codec.output_height), is_gray ? 1 : 3, 8, {}};
    raster.allocate();
    reader.run([&] {
        while (codec.output_scanline < codec.output_height) {
            JSAMPROW rows[] = {raster.row(static_cast<int>(codec.output_scanline))};
            jpeg_read_scanlines(&codec, rows, 1);
        }
        jpeg_finish_decompress(&codec);
    });
    return raster;
}

} // namespace formats

std::vector<std::byte> encode_jpeg(const ColorImage& image, int quality)
{
    if (image.empty()) throw ResourceError("cannot encode a JPEG: the image has no pixels");
    return Writer().write(image, quality);
}

} // namespace quoin
