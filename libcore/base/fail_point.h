// Points at which a test can end the process as `kill -9` or a failing disk would: docs/store.md lists them.
//
//     QUOIN_FAIL_POINT=object_published          the first time that the point is reached, the process is killed
//     QUOIN_FAIL_POINT=object_published:3        the third time
//     QUOIN_FAIL_POINT=merge/object_published    in the program of that name only
//     QUOIN_FAIL_POINT=object_written=EIO        as if the disk had failed there (EIO, ENOSPC)
#pragma once

#include <filesystem>

namespace quoin {

// Does nothing unless the environment names this point. `path` is what is being written there, for the message.
void fail_point(const char* name, const std::filesystem::path& path = {});

} // namespace quoin
