#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "client/display_file/mpcdi.h"

namespace tessera::display_file {

// A display file that shows what an archive describes, and the files that it names.
struct ImportedDisplay {
    std::string text;  // TOML: docs/displays.md
    struct File {
        std::string name;  // beside the display file
        std::vector<std::byte> content;
    };
    std::vector<File> files;
    std::vector<std::string> notices;  // what is left to people
};

// Every region becomes an output of its name (what is no letter or digit becomes '-'). 2d: warped on a screen
// of the buffer's shape, two metres wide and to be measured; 3d: on a screen two metres away where its
// frustum is; a3, and sl with points: at these points; sl without: a projector before a screen to be
// measured. `stem` begins the names of files.
ImportedDisplay import_mpcdi(const Mpcdi& mpcdi, const std::string& stem);

}  // namespace tessera::display_file
