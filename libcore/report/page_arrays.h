// Arrays and images inside the page: script elements of base64 text that page.js decodes.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace quoin {

std::string base64(std::span<const std::byte> bytes);

class PageArrays {
public:
    // element: "f32", "u32", "u16" or "u8"; T is made of such elements.
    template <class T>
    void add(const std::string& name, std::string_view element, const std::vector<T>& values)
    {
        add_element("array-" + name, "application/octet-stream", element, std::as_bytes(std::span(values)));
    }
    void add_image(const std::string& name, std::string_view mime, std::span<const std::byte> encoded)
    {
        add_element(name, mime, "", encoded);
    }
    std::string take() { return std::move(html_); }

private:
    void add_element(const std::string& id, std::string_view mime, std::string_view element,
                     std::span<const std::byte> bytes);
    std::string html_;
};

} // namespace quoin
