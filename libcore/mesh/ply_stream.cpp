#include "mesh/ply_stream.h"

#include "base/error.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fmt/format.h>

static_assert(std::endian::native == std::endian::little, "binary numbers are read as they lie in memory");

namespace quoin::ply {
namespace {

std::vector<std::string_view> split(std::string_view line)
{
    constexpr std::string_view kBlank = " \t\r";
    std::vector<std::string_view> words;
    for (auto begin = line.find_first_not_of(kBlank); begin != line.npos;) {
        const auto end = std::min(line.find_first_of(kBlank, begin), line.size());
        words.push_back(line.substr(begin, end - begin));
        begin = line.find_first_not_of(kBlank, end);
    }
    return words;
}

// Turns header lines into elements; knows where it is for messages.
class HeaderParser {
public:
    HeaderParser(std::string_view text, const std::string& name) : text_(text), name_(name) {}

    Header parse()
    {
        if (next_line() != "ply") throw InputError(name_ + ": is not a PLY file: its first line is not 'ply'");
        Header header;
        bool has_format = false;
        for (;;) {
            const auto words = split(next_line());
            if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
            if (words[0] == "end_header") break;
            if (words[0] == "format" && words.size() == 3) {
                header.encoding = encoding_of(words[1]);
                has_format = true;
            } else if (words[0] == "element" && words.size() == 3) {
                header.elements.push_back({std::string(words[1]), count_of(words[2]), {}});
            } else if (words[0] == "property" && !header.elements.empty()) {
                header.elements.back().properties.push_back(property_of(words));
            } else {
                fail("expected format, element, property or end_header");
            }
        }
        if (!has_format) throw InputError(name_ + ": the PLY header has no format line");
        header.size = position_;
        return header;
    }

private:
    [[noreturn]] void fail(const std::string& expected) const
    {
        throw InputError(fmt::format("{}:{}: '{}': {}", name_, line_number_, line_.substr(0, 80), expected));
    }

    std::string_view next_line()
    {
        const auto end = text_.find('\n', position_);
        if (end == text_.npos)
            throw InputError(fmt::format("{}:{}: the PLY header does not end", name_, line_number_ + 1));
        line_ = text_.substr(position_, end - position_);
        if (line_.ends_with('\r')) line_.remove_suffix(1);
        position_ = end + 1;
        ++line_number_;
        return line_;
    }

    Encoding encoding_of(std::string_view word) const
    {
        if (word == "ascii") return Encoding::Ascii;
        if (word == "binary_little_endian") return Encoding::LittleEndian;
        if (word == "binary_big_endian") return Encoding::BigEndian;
        fail("expected ascii, binary_little_endian or binary_big_endian");
    }

    std::size_t count_of(std::string_view word) const
    {
        std::uint64_t count = 0;
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), count);
        if (error != std::errc() || end != word.data() + word.size()) fail("expected a number of rows");
        return count;
    }

    Type type_of(std::string_view word) const
    {
        constexpr std::array<std::array<std::string_view, 2>, 8> kNames{{{"char", "int8"},
                                                                         {"uchar", "uint8"},
                                                                         {"short", "int16"},
                                                                         {"ushort", "uint16"},
                                                                         {"int", "int32"},
                                                                         {"uint", "uint32"},
                                                                         {"float", "float32"},
                                                                         {"double", "float64"}}};
        for (std::size_t i = 0; i < kNames.size(); ++i)
            if (word == kNames[i][0] || word == kNames[i][1]) return static_cast<Type>(i);
        fail("expected a number type such as float, uchar or int");
    }

    Property property_of(const std::vector<std::string_view>& words) const
    {
        if (words.size() == 3) return {std::string(words[2]), type_of(words[1]), std::nullopt};
        if (words.size() == 5 && words[1] == "list")
            return {std::string(words[4]), type_of(words[3]), type_of(words[2])};
        fail("expected 'property TYPE NAME' or 'property list TYPE TYPE NAME'");
    }

    std::string_view text_;
    const std::string& name_;
    std::string_view line_;
    std::size_t position_ = 0;
    std::size_t line_number_ = 0;
};

// The value at `data`, which holds enough bytes.
template <class T>
T load(const char* data, Encoding encoding)
{
    std::array<char, sizeof(T)> raw;
    std::memcpy(raw.data(), data, sizeof(T));
    if (encoding == Encoding::BigEndian) std::reverse(raw.begin(), raw.end());
    return std::bit_cast<T>(raw);
}

} // namespace

std::size_t size_of(Type type)
{
    constexpr std::array<std::size_t, 8> kSizes{1, 1, 2, 2, 4, 4, 4, 8};
    return kSizes[static_cast<std::size_t>(type)];
}

Header parse_header(std::string_view text, const std::string& name) { return HeaderParser(text, name).parse(); }

void Body::enter(const Element& element)
{
    element_ = &element;
    row_ = 0;
    if (element.count > rest_.size() / smallest_row(element))
        throw InputError(fmt::format("{}: is truncated: the header promises {} rows of '{}', but only {} bytes follow",
                                     name_, element.count, element.name, rest_.size()));
}

std::size_t Body::list_size(const Property& list)
{
    const double size = number(*list.count_type);
    const auto limit =
        static_cast<double>(encoding_ == Encoding::Ascii ? rest_.size() : rest_.size() / size_of(list.type));
    if (!(size >= 0.0 && size <= limit && size == std::floor(size)))
        fail(fmt::format("list '{}' of {} items does not fit the file", list.name, size));
    return static_cast<std::size_t>(size);
}

void Body::skip(const Property& property)
{
    const std::size_t items = property.count_type ? list_size(property) : 1;
    for (std::size_t i = 0; i < items; ++i)
        number(property.type);
}

void Body::fail(const std::string& what) const
{
    throw InputError(
        fmt::format("{}: element '{}', row {} of {}: {}", name_, element_->name, row_, element_->count, what));
}

// Fewest bytes of a row [bytes]; an ascii number takes a digit, its separator may be the end of the file.
std::size_t Body::smallest_row(const Element& element) const
{
    std::size_t size = 0;
    for (const auto& p : element.properties)
        size += encoding_ == Encoding::Ascii ? 1 : size_of(p.count_type.value_or(p.type));
    return std::max<std::size_t>(size, 1);
}

double Body::binary_number(Type type)
{
    const std::size_t size = size_of(type);
    if (rest_.size() < size) fail("the file is truncated here");
    const char* data = rest_.data();
    rest_.remove_prefix(size);
    switch (type) {
    case Type::I8:
        return load<std::int8_t>(data, encoding_);
    case Type::U8:
        return load<std::uint8_t>(data, encoding_);
    case Type::I16:
        return load<std::int16_t>(data, encoding_);
    case Type::U16:
        return load<std::uint16_t>(data, encoding_);
    case Type::I32:
        return load<std::int32_t>(data, encoding_);
    case Type::U32:
        return load<std::uint32_t>(data, encoding_);
    case Type::F32:
        return static_cast<double>(load<float>(data, encoding_));
    case Type::F64:
        break;
    }
    return load<double>(data, encoding_);
}

double Body::ascii_number()
{
    const auto begin = rest_.find_first_not_of(" \t\r\n");
    if (begin == rest_.npos) fail("the file is truncated here");
    rest_.remove_prefix(begin);
    const auto word = rest_.substr(0, rest_.find_first_of(" \t\r\n"));
    const auto digits = word.starts_with('+') ? word.substr(1) : word;
    double value = 0.0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc() || end != digits.data() + digits.size())
        fail(fmt::format("'{}' is not a number", word.substr(0, 40)));
    rest_.remove_prefix(word.size());
    return value;
}

} // namespace quoin::ply
