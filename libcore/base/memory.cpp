#include "base/memory.h"

#include <malloc.h>

namespace quoin {

void keep_freed_memory()
{
#ifdef __GLIBC__
    constexpr int kNever = 1 << 30; // [bytes]; what is larger is rare and goes back at once
    mallopt(M_MMAP_THRESHOLD, kNever);
    mallopt(M_TRIM_THRESHOLD, kNever);
    mallopt(M_TOP_PAD, 16 << 20);
#endif
}

} // namespace quoin
