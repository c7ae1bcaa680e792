#include "scan/digest.h"

#include "base/error.h"

#include <openssl/evp.h>

namespace quoin {

Sha256 sha256(std::span<const std::byte> bytes)
{
    Sha256 digest{};
    unsigned int size = 0;
    if (EVP_Digest(bytes.data(), bytes.size(), digest.data(), &size, EVP_sha256(), nullptr) != 1 ||
        size != digest.size())
        throw ResourceError("OpenSSL cannot compute a SHA-256");
    return digest;
}

} // namespace quoin
