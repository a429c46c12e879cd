#pragma once

#include "mediator/frame/film_tile.h"

namespace tessera::tools::bench {

// Fraction of the picture's light in pixels whose 5 x 5 window expects fewer than 3 of the samples that cause it, at
// `spp` samples per pixel: no denoiser can know such light from an accident. Light of probability p and value v has
// mean p v and second moment p v^2, so samples that expect mean^2 / second moment finds each. `film`: of many more
// samples, with radiance.
double rare_light(const frame::FilmTile& film, std::uint64_t spp);

}  // namespace tessera::tools::bench
