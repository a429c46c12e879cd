#pragma once

#include "client/display_file/output_reader.h"

// Keys of an output that name files of calibration tools. Errors in the files are reported at the key.
namespace tessera::display_file {

// `points = "FILE.pfm"`: x, y, z in display space where each pixel is seen.
display::WarpMap read_points(Section& section, const ReadContext& context);

// `warp = "FILE.pfm"` (u, v of the screen in the first two components, from the top left) or a mesh,
// `warp = "FILE.data"`, whose brightness becomes the output's weights.
display::WarpMap read_warp(Section& section, ReadContext& context, const display::Screen& screen,
                           display::Output& output);

// `weights` and `lift`: a PNG or PFM each. Returns whether either is present.
bool read_light_files(Section& section, ReadContext& context, display::Output& output);

// A grid whose nodes are at pixel centres.
display::Grid stored(const LoadedGrid& loaded, scene::BlobStore& blobs);

}  // namespace tessera::display_file
