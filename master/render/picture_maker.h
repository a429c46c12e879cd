#pragma once

#include <memory>
#include <optional>

#include "master/render/render_outputs.h"
#include "mediator/base/task_thread.h"

namespace tessera::master {

// What a picture is made of, as values.
struct PictureTask {
    std::uint64_t frame = 0;
    frame::FilmTile film;
    std::optional<frame::FilmTile> later;             // with channels that `film` lacks
    std::shared_ptr<const frame::FilmTile> features;  // of the full size, to upsample by; may be null
    view::View view;
    Version version;       // of the scene that the film shows
    PictureFormat format;  // None: only facts about the film
    bool hash_film = false;
};

// Filters and encodes on a thread of its own, so that merging goes on meanwhile. One picture after another,
// in the order asked for.
class PictureMaker {
  public:
    explicit PictureMaker(RenderOutputs& outputs) : outputs_(outputs) {}

    void make(PictureTask task);
    void make(OutputOrder order, std::vector<frame::FilmTile> films);
    // A made-up film of at most 256 x 256 pixels, since somebody is waiting.
    void rehearse(const view::View& view, session::PictureEncoding encoding);
    void forget(ViewId first, ViewId last);  // views [first, last)

  private:
    Reconstructed made(const PictureTask& task);

    RenderOutputs& outputs_;
    Reconstructor reconstructor_;  // of the thread alone
    TaskThread thread_;            // last: it ends first
};

}  // namespace tessera::master
