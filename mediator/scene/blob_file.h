#pragma once

#include <filesystem>

#include "mediator/base/error.h"
#include "mediator/scene/blob.h"

namespace tessera::scene {

// The name of a blob's file in a folder of blobs: its hash.
std::filesystem::path blob_path(const std::filesystem::path& folder, const BlobRef& blob);

// Verified; null when absent or damaged.
BlobPtr read_blob(const std::filesystem::path& folder, const BlobRef& blob);

// Written under another name first: the file is there in full or not at all. Does nothing when it is there.
Expected<void> write_blob(const std::filesystem::path& folder, const Blob& blob);

}  // namespace tessera::scene
