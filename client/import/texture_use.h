#pragma once

namespace tessera::import {

enum class TextureUse {
    Color,  // sRGB; a magenta checker stands for a bad one
    Data    // linear; a bad one is left out, the factor alone stays
};

}  // namespace tessera::import
