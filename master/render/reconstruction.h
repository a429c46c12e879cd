#pragma once

#include <memory>
#include <string>

#include "mediator/filter/choice.h"
#include "mediator/frame/film_tile.h"
#include "mediator/wire/messages.h"

namespace tessera::master {

// A picture made of a film, and how.
struct Reconstruction {
    wire::PictureSummary summary;
    std::shared_ptr<const std::vector<std::byte>> bytes;  // never null; empty when it failed
    std::string error;
};

// What a picture is made of.
struct Films {
    const frame::FilmTile& film;
    const frame::FilmTile* later = nullptr;  // of only some of the samples, for channels that `film` lacks
    const frame::FilmTile* features =
        nullptr;  // of the full size, if `film` is smaller and is to be upsampled
};

// Filters whole films and encodes them; each picture for itself, without history. Keeps the memory of the
// last filter as long as filter and size stay the same. One thread calls; the work runs on all cores.
class Reconstructor {
  public:
    Reconstruction reconstruct(const Films& films, const view::View& view, wire::PictureEncoding encoding);

    // The filtered picture alone, in memory of this object until the next call. Throws Error.
    const filter::Planes& filtered(const frame::FilmTile& film, const view::View& view);
    tbb::task_arena& arena() { return arena_; }

    // Seconds that the same takes on a made-up film of about `pixels`: for the first prediction.
    double rehearse(const view::View& view, wire::PictureEncoding encoding, std::uint32_t width,
                    std::uint32_t height);

  private:
    struct Instance {
        std::string name;
        std::uint32_t width = 0, height = 0;
        std::unique_ptr<filter::Filter> filter;
    };
    filter::Filter& instance(const filter::Choice& choice, std::uint32_t width, std::uint32_t height);

    tbb::task_arena arena_;
    Instance instance_;
    filter::Output output_;
    filter::Planes upsampled_;
};

}  // namespace tessera::master
