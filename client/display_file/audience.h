#pragma once

#include <tbb/task_arena.h>

#include <string>
#include <vector>

#include "client/display_file/display_file.h"
#include "mediator/frame/image.h"

namespace tessera::display_file {

// What people in front of one screen see with one eye.
struct ScreenPicture {
    std::string screen;  // its name, or that of the output that has it for itself
    view::Eye eye = view::Eye::Mono;
    frame::Image light;  // linear
};

struct AudienceOptions {
    std::uint32_t width = 1920;  // of each picture; its height follows from the screen's shape
    double black = 0.0;          // light of a device that is sent black, as a part of its white
};

// The outputs' pictures in `folder` thrown back onto their screens: NAME.png, or NAME-left.png and
// NAME-right.png where the eyes have pictures of their own. A flat wall is seen from straight ahead, other
// screens from where the head is. Screens on which an output packs or keeps two eyes apart have a picture for
// each; anaglyphs are what glasses would take apart. Throws Error{NotFound, InvalidInput} with the file that
// is missing or has another size than its output.
std::vector<ScreenPicture> what_people_see(const DisplayFile& file, const std::string& folder,
                                           const AudienceOptions& options, tbb::task_arena& arena);

}  // namespace tessera::display_file
