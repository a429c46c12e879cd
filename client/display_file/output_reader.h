#pragma once

#include <map>

#include "client/display_file/display_file.h"
#include "client/display_file/loaded_grid.h"
#include "client/display_file/section.h"

namespace tessera::display_file {

// [[screen]]
struct NamedScreen {
    display::Screen surface;
    double black = 0.0;  // black level of its projectors, as a fraction of white
};

// Shared by all outputs while reading.
struct ReadContext {
    std::string folder;  // paths are relative to it
    std::map<std::string, NamedScreen> screens;
    display::Head head;
    scene::BlobStore& blobs;
};

// An output and its section, for errors.
struct ReadOutput {
    display::Output output;
    OutputGeometry geometry;
    Section section;
    bool has_own_blend = false;  // the file has soft edges for it
};

// Reads the key `name`; errors then call the section `what` 'NAME'.
std::string read_name(Section& section, const char* what);

// [[output]]
ReadOutput read_output(Section section, ReadContext& context);

// [[wall]]: the outputs of a grid, row by row from the top left, named WALL-COLUMN-ROW from 1-1.
std::vector<ReadOutput> read_wall_outputs(Section section);

}  // namespace tessera::display_file
