#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <variant>
#include <vector>

#include "master/frame_assembler.h"
#include "master/reconstruction.h"
#include "mediator/net/channel.h"
#include "mediator/wire/messages.h"

namespace tessera::master {

// What became of one film message.
struct MergeReport {
    net::PeerId peer = 0;  // bulk peer that sent it
    UnitId unit;
    ViewId view;
    std::uint64_t revision = 0;
    std::uint16_t part = 0, parts = 1;
    frame::SampleBlock block;
    std::uint64_t pixel_samples = 0, nonfinite = 0, rays = 0;
    Duration busy{};
    FrameAssembler::Result result;
    bool stale = false;      // of a view or revision that is not being assembled
    bool malformed = false;  // not decodable; the rest means nothing
};
// One merged tile on its way to a client.
struct EncodedTile {
    JobId job;
    net::Bytes bytes;
};
// The picture of a job, or why there is none.
struct Reconstructed {
    JobId job;
    Reconstruction picture;
    std::uint64_t samples_least = 0, samples_most = 0;
};
// How long a made-up picture took.
struct Rehearsed {
    JobId job;
    std::uint64_t pixels = 0;
    double seconds = 0.0;
};
using MergerOutput = std::variant<MergeReport, EncodedTile, Reconstructed, Rehearsed>;

// Decodes, merges and filters film on a thread of its own, so that the loop that keeps heartbeats never does.
// Tasks run in the order given; `wake` is called (from the merger's thread) whenever output is there.
class FilmMerger {
  public:
    explicit FilmMerger(std::function<void()> wake);
    ~FilmMerger();

    void open(ViewId view, std::uint64_t revision, FrameAssembler assembler);
    void close();  // drops the film
    // The open film goes on under another revision, with more channels.
    void widen(std::uint64_t revision, frame::ChannelSet channels);
    void keep_features();  // the film that is open is of the full size: for upsampling the next one's picture
    void push(net::PeerId peer, net::Bytes film_message);
    void deliver(JobId job, std::uint32_t first_tile, std::uint32_t last_tile);  // encodes [first, last)

    void reconstruct(JobId job, const view::View& view, wire::PictureEncoding encoding);
    void rehearse(JobId job, const view::View& view, wire::PictureEncoding encoding);

    std::vector<MergerOutput> take();
    std::size_t queued_bytes() const;

  private:
    struct Open {
        ViewId view;
        std::uint64_t revision;
        std::shared_ptr<FrameAssembler> assembler;
    };
    struct Close {};
    struct KeepFeatures {};
    struct Widen {
        std::uint64_t revision;
        frame::ChannelSet channels;
    };
    struct Film {
        net::PeerId peer;
        net::Bytes bytes;
    };
    struct Deliver {
        JobId job;
        std::uint32_t first, last;
    };
    struct Reconstruct {
        JobId job;
        view::View view;
        wire::PictureEncoding encoding;
    };
    struct Rehearse : Reconstruct {};
    using Task = std::variant<Open, Close, KeepFeatures, Widen, Film, Deliver, Reconstruct, Rehearse>;

    void enqueue(Task task, std::size_t bytes);
    void run(std::stop_token stop);
    void perform(Open& task);
    void perform(Close& task);
    void perform(KeepFeatures& task);
    void perform(Widen& task);
    void perform(Film& task);
    void perform(Deliver& task);
    void perform(Reconstruct& task);
    void perform(Rehearse& task);
    void put(MergerOutput output);

    std::function<void()> wake_;
    // Of the merger's thread alone:
    ViewId view_;
    std::uint64_t revision_ = 0;
    std::shared_ptr<FrameAssembler> assembler_;
    std::optional<frame::FilmTile> features_;
    Reconstructor reconstructor_;

    mutable std::mutex mutex_;  // protects what stands below
    std::condition_variable_any changed_;
    std::deque<Task> tasks_;
    std::vector<MergerOutput> output_;
    std::size_t queued_bytes_ = 0;

    std::jthread thread_;  // last: starts when all else is there
};

}  // namespace tessera::master
