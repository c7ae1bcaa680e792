#include "artifact/mapped_file.h"

#include "base/error.h"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

namespace quoin {

MappedFile::MappedFile(const std::filesystem::path& path)
{
    const auto fail = [&](const char* doing) -> void {
        throw InputError(path.string() + ": " + doing + ": " + std::strerror(errno));
    };
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) fail("cannot open");
    struct stat status {};
    if (::fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) {
        ::close(descriptor);
        throw InputError(path.string() + ": not a regular file");
    }
    size_ = static_cast<std::size_t>(status.st_size);
    void* address = size_ > 0 ? ::mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, descriptor, 0) : nullptr;
    ::close(descriptor);
    if (address == MAP_FAILED) fail("cannot map");
    data_ = static_cast<const std::byte*>(address);
}

MappedFile::~MappedFile()
{
    if (data_ != nullptr) ::munmap(const_cast<std::byte*>(data_), size_);
}

} // namespace quoin
