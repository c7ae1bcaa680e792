// The header and the numbers of a PLY file, whatever its encoding: what ply.cpp gives a meaning to.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace quoin::ply {

enum class Encoding { Ascii, LittleEndian, BigEndian };
enum class Type : std::uint8_t { I8, U8, I16, U16, I32, U32, F32, F64 };

struct Property {
    std::string name;
    Type type = Type::F32;
    std::optional<Type> count_type; // of a list
};

struct Element {
    std::string name;
    std::size_t count = 0;
    std::vector<Property> properties;
};

struct Header {
    Encoding encoding = Encoding::Ascii;
    std::vector<Element> elements;
    std::size_t size = 0; // [bytes], the end_header line included
};

std::size_t size_of(Type type); // [bytes]

// Throws InputError naming file and line. The name must outlive what is made here.
Header parse_header(std::string_view text, const std::string& name);

// Reads the numbers after the header one by one. Throws InputError naming file, element and row.
class Body {
public:
    Body(std::string_view data, Encoding encoding, const std::string& name)
        : rest_(data), encoding_(encoding), name_(name)
    {
    }

    void enter(const Element& element); // checks that its rows can fit the rest of the file
    void next_row() { ++row_; }
    double number(Type type) { return encoding_ == Encoding::Ascii ? ascii_number() : binary_number(type); }
    std::size_t list_size(const Property& list);
    void skip(const Property& property);
    [[noreturn]] void fail(const std::string& what) const;

private:
    std::size_t smallest_row(const Element& element) const;
    double binary_number(Type type);
    double ascii_number();

    std::string_view rest_;
    Encoding encoding_;
    const std::string& name_;
    const Element* element_ = nullptr;
    std::size_t row_ = 0;
};

} // namespace quoin::ply
