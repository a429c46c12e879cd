#pragma once

namespace tessera::import {

enum class TextureUse {
    Color,  // sRGB; a magenta checkerboard replaces an invalid one
    Data    // linear; an invalid one is ignored, only the factor is used
};

}  // namespace tessera::import
