#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace tessera::picture {

// Calls write(temporary name in the same folder) and renames the file, so that it is never incomplete. If `write`
// throws, the temporary file is removed. Throws Error{Io} with the path and the remedy.
void write_atomically(const std::string& path, const std::function<void(const std::string&)>& write);

// The same with given content.
void write_atomically(const std::string& path, std::string_view content);

}  // namespace tessera::picture
