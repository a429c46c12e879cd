#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "client/display_file/mpcdi.h"

namespace tessera::display_file {

// A display file for the contents of an archive, and the files that it refers to.
struct ImportedDisplay {
    std::string text;  // TOML: docs/displays.md
    struct File {
        std::string name;  // in the display file's folder
        std::vector<std::byte> content;
    };
    std::vector<File> files;
    std::vector<std::string> notices;  // remaining manual steps
};

// Every region becomes an output of its name (characters other than letters and digits become '-'). 2d: warped on a
// screen of the buffer's aspect ratio, two metres wide and to be measured; 3d: on a screen two metres away along its
// frustum; a3, and sl with points: at these points; sl without: a projector in front of a screen to be measured.
// `stem` is the prefix of file names.
ImportedDisplay import_mpcdi(const Mpcdi& mpcdi, const std::string& stem);

}  // namespace tessera::display_file
