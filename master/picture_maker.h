#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "master/reconstruction.h"

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
    using Made = std::variant<Reconstructed, Rehearsed>;
    explicit PictureMaker(std::function<void(Made)> done);  // called on that thread
    ~PictureMaker();

    void make(PictureTask task);
    // A made-up film of at most 256 x 256 pixels, since somebody is waiting.
    void rehearse(JobId job, const view::View& view, wire::PictureEncoding encoding);

  private:
    struct Rehearsal {
        JobId job;
        view::View view;
        wire::PictureEncoding encoding;
    };
    using Task = std::variant<PictureTask, Rehearsal>;

    void enqueue(Task task);
    void run(std::stop_token stop);
    Made perform(PictureTask& task);
    Made perform(Rehearsal& task);

    std::function<void(Made)> done_;
    Reconstructor reconstructor_;  // of the thread alone

    std::mutex mutex_;  // protects tasks_
    std::condition_variable_any changed_;
    std::deque<Task> tasks_;

    std::jthread thread_;  // last: starts when all else is there
};

}  // namespace tessera::master
