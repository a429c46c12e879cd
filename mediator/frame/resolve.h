#pragma once

#include <span>

#include "mediator/base/hash.h"
#include "mediator/frame/film_tile.h"
#include "mediator/frame/image.h"

namespace tessera::frame {

// Divides by the sample count. Pixels without samples resolve to 0 (+inf for depth). `plane`: one component in
// raster order, as filters read it; it has the film's pixels.
void resolve(const FilmTile& film, Channel channel, std::uint32_t component, std::span<float> plane);
void resolve_variance_of_mean(const FilmTile& film, Channel channel, std::uint32_t component,
                              std::span<float> plane);
void resolve_counts(const FilmTile& film, std::span<float> plane);

// The same with interleaved components, for files and metrics.
Image resolve(const FilmTile& film, Channel channel);                   // mean, sum / n, or the value itself
Image resolve_picture(const FilmTile& film);                            // Radiance, or Color without it
Image resolve_variance_of_mean(const FilmTile& film, Channel channel);  // M2 / (n (n - 1)); 0 for n < 2
Image resolve_counts(const FilmTile& film);  // accepted samples per pixel, 1 component

// BLAKE2b over the merged planes: size, then counts, then each channel's planes in raster order;
// little-endian. Independent of tiles, nodes and time.
Hash256 film_hash(const FilmTile& film);

}  // namespace tessera::frame
