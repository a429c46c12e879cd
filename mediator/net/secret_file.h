#pragma once

#include <filesystem>
#include <string>

namespace tessera::net {

enum class Visibility { Owner, Everyone };  // 0600, 0644

// Written under a temporary name and renamed, so that no reader sees a partial file. Throws Error{Io}.
void write_text(const std::filesystem::path& path, const std::string& text, Visibility visibility);

// At most 1 MiB. Throws Error{NotFound, Io}.
std::string read_text(const std::filesystem::path& path);

// Throws Error{Refused} with the remedy if group or others may write the file, or others its folder.
void require_unwritable(const std::filesystem::path& path);

// Throws Error{Refused} with the remedy if group or others may read or write the file.
void require_private(const std::filesystem::path& path);

}  // namespace tessera::net
