#pragma once

#include <functional>
#include <string>

namespace tessera::picture {

// Calls write(temporary name in the same folder) and renames: the file is there in full or not at all. What
// `write` throws goes on, after the temporary file was removed. Throws Error{Io} with the path and the
// remedy.
void write_atomically(const std::string& path, const std::function<void(const std::string&)>& write);

}  // namespace tessera::picture
