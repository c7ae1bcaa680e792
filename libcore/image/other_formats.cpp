#include "image/other_formats.h"

#include "base/error.h"
#include "image/other/library.h"

#include <dlfcn.h>
#include <filesystem>

namespace quoin::formats {
namespace {

template <class Function>
Function* find(void* library, const char* name)
{
    return library ? reinterpret_cast<Function*>(::dlsym(library, name)) : nullptr;
}

struct Library {
    InspectFunction* inspect = nullptr;
    DecodeFunction* decode = nullptr;

    // It lies beside the programs.
    Library()
    {
        const auto place = std::filesystem::read_symlink("/proc/self/exe").parent_path() / kLibraryName;
        void* library = ::dlopen(place.c_str(), RTLD_NOW | RTLD_LOCAL);
        inspect = find<InspectFunction>(library, kInspectName);
        decode = find<DecodeFunction>(library, kDecodeName);
        if (inspect && decode) return;
        const char* why = ::dlerror();
        throw ResourceError(place.string() + ": cannot load what reads images other than JPEG and PNG: " +
                            (why ? why : "another version") + "; build or install Quoin anew");
    }
};

const Library& library()
{
    static const Library library;
    return library;
}

void refuse_unless_empty(const std::string& fault, const std::string& name)
{
    if (!fault.empty()) refuse(name, fault, kReadFormats);
}

} // namespace

ImageInfo inspect_other(Bytes bytes, const std::string& name)
{
    ImageInfo info;
    refuse_unless_empty(library().inspect(bytes, name, info), name);
    return info;
}

Raster decode_other(Bytes bytes, const std::string& name, const Request& request)
{
    Raster raster;
    refuse_unless_empty(library().decode(bytes, request, raster), name);
    return raster;
}

} // namespace quoin::formats
