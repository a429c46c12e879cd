#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mediator/frame/film_tile.h"
#include "mediator/frame/image.h"
#include "mediator/picture/exr_writer.h"

namespace tessera::picture {

// A film as a file for people and for filters.
struct FilmFile {
    std::uint32_t width = 0, height = 0;  // of the whole picture; the film covers its rect
    frame::FilmTile film;
    std::map<std::string, std::string> attributes;
};

enum class Statistics { Left, Saved };

// One EXR: R G B (A) is `filtered`, if there is one (3 or 4 components), then layer `raw` is the radiance as
// it was sampled; otherwise R G B is the radiance. Further layers: its variance of the mean, every other
// channel of the film resolved, object ids, sample counts; each channel's merge rule among the attributes.
// Statistics::Saved adds the film itself, plane by plane (layers statistics.CHANNEL), from which
// read_film_exr() makes it again, bit by bit. In full or not at all; throws Error{Io}.
void write_film_exr(const std::string& path, const FilmFile& file,
                    const std::optional<frame::Image>& filtered = {},
                    Statistics statistics = Statistics::Left, const std::vector<Layer>& more = {});

// Throws Error{NotFound, InvalidInput}: no such file, damaged, or written without its statistics.
FilmFile read_film_exr(const std::string& path);

}  // namespace tessera::picture
