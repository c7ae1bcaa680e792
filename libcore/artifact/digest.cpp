#include "artifact/digest.h"

#include "base/error.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <openssl/evp.h>
#include <vector>
#include <xxhash.h>

namespace quoin {

struct Sha256Stream::Impl {
    EVP_MD_CTX* context = EVP_MD_CTX_new();
};

Sha256Stream::Sha256Stream() : impl_(std::make_unique<Impl>())
{
    EVP_DigestInit_ex(impl_->context, EVP_sha256(), nullptr);
}
Sha256Stream::~Sha256Stream() { EVP_MD_CTX_free(impl_->context); }

void Sha256Stream::update(std::span<const std::byte> bytes)
{
    EVP_DigestUpdate(impl_->context, bytes.data(), bytes.size());
}
void Sha256Stream::update(std::string_view text) { update(std::as_bytes(std::span(text.data(), text.size()))); }

std::array<std::uint8_t, 32> Sha256Stream::finish()
{
    std::array<std::uint8_t, 32> digest{};
    EVP_DigestFinal_ex(impl_->context, digest.data(), nullptr);
    return digest;
}

std::string to_hex(std::span<const std::uint8_t> bytes)
{
    constexpr char digits[] = "0123456789abcdef";
    std::string text;
    text.reserve(2 * bytes.size());
    for (const std::uint8_t byte : bytes) {
        text += digits[byte >> 4];
        text += digits[byte & 15];
    }
    return text;
}

std::string sha256_hex(std::string_view text)
{
    Sha256Stream stream;
    stream.update(text);
    return to_hex(stream.finish());
}

std::string sha256_hex_of_file(const std::filesystem::path& path)
{
    std::ifstream file(path, std::ios::binary);
    if (!file) throw InputError(path.string() + ": cannot read: " + std::strerror(errno));
    Sha256Stream stream;
    std::vector<char> buffer(std::size_t{1} << 18);
    while (file) {
        file.read(buffer.data(), static_cast<std::streamsize>(buffer.size()));
        stream.update(std::string_view(buffer.data(), static_cast<std::size_t>(file.gcount())));
    }
    if (file.bad()) throw InputError(path.string() + ": cannot read: " + std::strerror(errno));
    return to_hex(stream.finish());
}

std::string checksum_hex(std::span<const std::byte> bytes)
{
    const XXH128_hash_t hash = XXH3_128bits(bytes.data(), bytes.size());
    XXH128_canonical_t canonical;
    XXH128_canonicalFromHash(&canonical, hash);
    return to_hex(canonical.digest);
}

} // namespace quoin
