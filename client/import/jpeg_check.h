#pragma once

#include <span>

#include "mediator/base/error.h"

namespace tessera::import {

// Checks a JPEG before stb_image decodes it, which allocates the size in the header and decodes every scan in full, even
// one without data: the size must be within ImageLimits and one that the bytes can hold (a block of 8 x 8 samples takes
// at least two bits, in a progressive image one), the scans at most MaxJpegScans and MaxJpegScanPixels, the codes of a
// Huffman table at most 256, and the tables that a scan reads must come before it. What is malformed otherwise is left to
// the decoder.
Expected<void> check_jpeg(std::span<const unsigned char> bytes);

}  // namespace tessera::import
