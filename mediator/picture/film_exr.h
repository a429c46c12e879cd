#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mediator/frame/film_state.h"
#include "mediator/frame/film_tile.h"
#include "mediator/frame/image.h"
#include "mediator/picture/exr_writer.h"

namespace tessera::picture {

// A film file: layers for viewers, statistics for filters.
struct FilmFile {
    std::uint32_t width = 0, height = 0;  // of the whole picture; the film covers its rect
    frame::FilmTile film;
    std::map<std::string, std::string> attributes;
    std::optional<frame::FilmState> state{};  // of the film, so that it can be continued
};

enum class Statistics { Omit, Include };

// What viewers show of a film: R G B (A) is `filtered`, if given (3 or 4 components), and layer `raw` the unfiltered radiance;
// otherwise R G B is the radiance. Further layers: its variance of the mean, its noise (noise_map.h), every other channel of the
// film resolved, object ids, sample counts.
std::vector<Layer> film_layers(const frame::FilmTile& film, const std::optional<frame::Image>& filtered);

// One EXR: the layers of the film, with each channel's merge rule among the attributes.
// Statistics::Include adds the film itself, plane by plane (layers statistics.CHANNEL), and its state, if there is one
// (film_state_layers.h), from which read_film_exr() restores both bit by bit. The file is never incomplete; throws Error{Io}.
void write_film_exr(const std::string& path, const FilmFile& file,
                    const std::optional<frame::Image>& filtered = {},
                    Statistics statistics = Statistics::Omit, const std::vector<Layer>& more = {});

// Throws Error{NotFound} if there is no such file, Error{InvalidInput} if it is damaged or has no statistics. A file without
// a state has none either when one is asked for.
enum class State { LeftOut, Included };
FilmFile read_film_exr(const std::string& path, State state = State::LeftOut);

}  // namespace tessera::picture
