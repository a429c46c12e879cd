#pragma once

#include <tbb/task_arena.h>

#include <string>
#include <vector>

#include "client/display_file/display_file.h"
#include "mediator/frame/image.h"

namespace tessera::display_file {

// What a viewer in front of one screen sees with one eye.
struct ScreenPicture {
    std::string screen;  // its name, or that of its only output
    view::Eye eye = view::Eye::Mono;
    frame::Image light;  // linear
};

struct ViewerPreviewOptions {
    std::uint32_t width = 1920;  // of each picture; its height follows from the screen's shape
    double black = 0.0;          // black level of the devices, as a fraction of white
};

// Projects the outputs' pictures in `folder` back onto their screens: NAME.png, or NAME-left.png and NAME-right.png
// where the eyes have separate pictures. A flat wall is seen from straight ahead, other screens from the head's
// position. Screens with a stereo output have a picture per eye, except for anaglyphs, which only glasses separate.
// Throws Error{NotFound, InvalidInput} with the file that is missing or does not have the size of its output.
std::vector<ScreenPicture> simulate_viewer(const DisplayFile& file, const std::string& folder,
                                           const ViewerPreviewOptions& options, tbb::task_arena& arena);

}  // namespace tessera::display_file
