#pragma once

#include <map>

#include "client/display_file/display_file.h"
#include "client/display_file/loaded_grid.h"
#include "client/display_file/section.h"

namespace tessera::display_file {

// [[screen]]
struct NamedScreen {
    display::Screen surface;
    double black = 0.0;  // light of a projector that is sent black, as a part of its white
};

// What outputs are read with.
struct ReadContext {
    std::string folder;  // that names of files are relative to
    std::map<std::string, NamedScreen> screens;
    display::Head head;
    scene::BlobStore& blobs;
};

// An output with the place in the file that errors about it name.
struct ReadOutput {
    display::Output output;
    OutputGeometry geometry;
    Section section;
    bool has_own_blend = false;  // the file says something about its soft edges
};

// Takes the key `name`, after which errors call the section: `what` 'NAME'.
std::string read_name(Section& section, const char* what);

// [[output]]
ReadOutput read_output(Section section, ReadContext& context);

// [[wall]]: the outputs of a grid, row by row from the top left, named WALL-COLUMN-ROW from 1-1.
std::vector<ReadOutput> read_wall_outputs(Section section);

}  // namespace tessera::display_file
