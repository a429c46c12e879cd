#pragma once

#include <filesystem>

#include "client/display/presenter.h"

namespace tessera::client_display {

// Keeps FOLDER/NAME.png (NAME-left.png and NAME-right.png of two pictures) at the frame that is shown now:
// prepare() writes beside it, present() renames, so whoever reads a file has a whole
// picture; of two, one may be a frame ahead for a moment.
std::unique_ptr<Presenter> make_picture_files(const std::filesystem::path& folder,
                                              const display::Output& output);

}  // namespace tessera::client_display
