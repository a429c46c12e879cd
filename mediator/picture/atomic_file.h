#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace tessera::picture {

// Calls write(temporary name in the same folder) and renames: the file is there in full or not at all. What
// `write` throws goes on, after the temporary file was removed. Throws Error{Io} with the path and the
// remedy.
void write_atomically(const std::string& path, const std::function<void(const std::string&)>& write);

// The same for content that is there already.
void write_atomically(const std::string& path, std::string_view content);

}  // namespace tessera::picture
