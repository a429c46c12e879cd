#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "master/render/render_outputs.h"
#include "mediator/base/task_thread.h"

namespace tessera::master {

// The inputs of one picture, by value.
struct PictureTask {
    std::uint64_t frame = 0;
    frame::FilmTile film;
    std::optional<frame::FilmTile> later;             // with channels that `film` lacks
    std::shared_ptr<const frame::FilmTile> features;  // of the full size, to upsample by; may be null
    view::View view;
    SceneState scene;      // in the film
    PictureFormat format;  // None: only facts about the film
    bool hash_film = false;
};

// Filters and encodes pictures on its own thread, so that merging continues meanwhile. Pictures are made one
// after another, in order of request.
class PictureWorker {
  public:
    explicit PictureWorker(RenderOutputs& outputs) : outputs_(outputs) {}

    void make(PictureTask task);
    void make(OutputRequest request, std::vector<frame::FilmTile> films);
    // Times a synthetic film of at most 256 x 256 pixels: small, since a client is waiting.
    void calibrate(const view::View& view, session::PictureEncoding encoding);
    void forget(ViewId first, ViewId last);  // views [first, last)

  private:
    Reconstructed reconstruct(const PictureTask& task);
    void post(const char* what, std::function<void()> task);

    RenderOutputs& outputs_;
    Reconstructor reconstructor_;  // only used by the thread
    TaskThread thread_;            // last: it ends first
};

}  // namespace tessera::master
