#pragma once

#include <filesystem>

#include "client/display/presenter.h"

namespace tessera::client_display {

// Keeps FOLDER/NAME.png (NAME-left.png and NAME-right.png for two pictures) updated with the presented frame.
// prepare() writes a temporary file, present() renames it, so readers always see whole pictures; of two, one may be a
// frame ahead for a moment.
std::unique_ptr<Presenter> make_picture_files(const std::filesystem::path& folder,
                                              const display::Output& output);

}  // namespace tessera::client_display
