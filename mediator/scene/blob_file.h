#pragma once

#include <filesystem>

#include "mediator/base/error.h"
#include "mediator/scene/blob.h"

namespace tessera::scene {

// The name of a blob's file in a folder of blobs: its hash.
std::filesystem::path blob_path(const std::filesystem::path& folder, const BlobRef& blob);

// Verified; null when absent or damaged.
BlobPtr read_blob(const std::filesystem::path& folder, const BlobRef& blob);

// Written to a temporary file and renamed, so that it is never incomplete. Does nothing if the file exists.
Expected<void> write_blob(const std::filesystem::path& folder, const Blob& blob);

// Writes it even if the file exists, and syncs it to disk.
Expected<void> replace_blob(const std::filesystem::path& folder, const Blob& blob);

}  // namespace tessera::scene
