#pragma once

#include <optional>
#include <string>
#include <vector>

#include "client/job.h"

namespace tessera::tools {

enum class PictureFormat { Exr, Png };

// By the end of the name; nothing for what cannot be written.
std::optional<PictureFormat> picture_format(const std::string& path);

// How a film came about, for whoever opens the file later.
struct Origin {
    std::string scene;  // the file's name
    std::string camera;
    std::string film_hash;
};

// Resolves the film and writes it to every path. A file is there in full or not at all. Throws Error{Io}.
void write_pictures(const std::vector<std::string>& paths, const client::JobRequest& request,
                    const client::JobResult& result, const Origin& origin);

}  // namespace tessera::tools
