#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <variant>

#include "master/render/output_maker.h"
#include "master/render/reconstruction.h"
#include "mediator/base/task_thread.h"

namespace tessera::master {

// What a picture is made of, as values.
struct PictureTask {
    JobId job;  // whose picture, as the asker counts
    frame::FilmTile film;
    std::optional<frame::FilmTile> later;             // with channels that `film` lacks
    std::shared_ptr<const frame::FilmTile> features;  // of the full size, to upsample by; may be null
    view::View view;
    wire::PictureEncoding encoding = wire::PictureEncoding::None;  // None: only facts about the film
    bool hash_film = false;
};

// The picture of a job or frame, or why there is none.
struct Reconstructed {
    JobId job;
    Reconstruction picture;
    std::uint64_t samples_least = 0, samples_most = 0;
    std::optional<Hash256> film_hash;
};

// How long a made-up picture took.
struct Rehearsed {
    JobId job;
    std::uint64_t pixels = 0;
    double seconds = 0.0;
};

// Filters and encodes on a thread of its own, so that merging goes on meanwhile. One picture after another,
// in the order asked for.
class PictureMaker {
  public:
    using Made = std::variant<Reconstructed, Rehearsed, MadeOutput>;
    explicit PictureMaker(std::function<void(Made)> done) : done_(std::move(done)) {}  // on that thread

    void make(PictureTask task);
    void make(OutputOrder order, std::vector<frame::FilmTile> films);
    // A made-up film of at most 256 x 256 pixels, since somebody is waiting.
    void rehearse(JobId job, const view::View& view, wire::PictureEncoding encoding);

  private:
    Reconstructed made(const PictureTask& task);

    std::function<void(Made)> done_;
    Reconstructor reconstructor_;  // of the thread alone
    TaskThread thread_;            // last: it ends first
};

}  // namespace tessera::master
