#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <variant>
#include <vector>

#include "master/render/frame_assembler.h"
#include "master/render/picture_maker.h"
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
// The film of a view as it lies: the blocks of all tiles.
struct FilmBlocks {
    JobId job;
    ViewId view;
    std::uint64_t revision = 0;
    std::vector<frame::FilmTile> blocks;
};
using MergerOutput = std::variant<MergeReport, EncodedTile, FilmBlocks, Reconstructed, Rehearsed, MadeOutput>;

// Decodes and merges film on a thread of its own, so that the loop that keeps heartbeats never does; pictures
// of it are made on another one. Any number of films, one a view. Tasks run in the order given; `wake` is
// called (from these threads) whenever output is there.
class FilmMerger {
  public:
    explicit FilmMerger(std::function<void()> wake);
    ~FilmMerger();

    void open(ViewId view, std::uint64_t revision, FrameAssembler assembler);  // replaces an older film of it
    void close(ViewId view);
    // The film goes on under another revision, with more channels.
    void widen(ViewId view, std::uint64_t revision, frame::ChannelSet channels);
    // The film ends here: it has the full size, for upsampling the picture of another one.
    void keep_features(ViewId view, ViewId of_picture);
    void push(net::PeerId peer, net::Bytes film_message);
    void deliver(ViewId view, JobId job, std::uint32_t first_tile, std::uint32_t last_tile);  // [first, last)
    void copy(ViewId view, JobId job);  // FilmBlocks, or nothing when there is no such film

    enum class FilmHash { Wanted, NotWanted };
    // Of the film of view.id. Nothing comes when there is no such film.
    void reconstruct(JobId job, const view::View& view, wire::PictureEncoding encoding, FilmHash hash);
    // Of the films of all layers of all eyes. Always comes; with an error when a film is gone.
    void make_output(OutputOrder order);
    void rehearse(JobId job, const view::View& view, wire::PictureEncoding encoding);

    std::vector<MergerOutput> take();
    std::size_t queued_bytes() const;

  private:
    struct Open {
        ViewId view;
        std::uint64_t revision;
        std::shared_ptr<FrameAssembler> assembler;
    };
    struct Close {
        ViewId view;
    };
    struct KeepFeatures {
        ViewId view, of_picture;
    };
    struct Widen {
        ViewId view;
        std::uint64_t revision;
        frame::ChannelSet channels;
    };
    struct Film {
        net::PeerId peer;
        net::Bytes bytes;
    };
    struct Deliver {
        ViewId view;
        JobId job;
        std::uint32_t first, last;
    };
    struct Copy {
        ViewId view;
        JobId job;
    };
    struct Reconstruct {
        JobId job;
        view::View view;
        wire::PictureEncoding encoding;
        FilmHash hash;
    };
    using Task =
        std::variant<Open, Close, KeepFeatures, Widen, Film, Deliver, Copy, Reconstruct, OutputOrder>;
    struct OpenFilm {
        std::uint64_t revision = 0;
        std::shared_ptr<FrameAssembler> assembler;
        std::shared_ptr<const frame::FilmTile> features;
    };

    void enqueue(Task task, std::size_t bytes);
    void run(std::stop_token stop);
    void perform(Open& task);
    void perform(Close& task);
    void perform(KeepFeatures& task);
    void perform(Widen& task);
    void perform(Film& task);
    void perform(Deliver& task);
    void perform(Copy& task);
    void perform(Reconstruct& task);
    void perform(OutputOrder& task);
    OpenFilm* film(ViewId view);
    void put(MergerOutput output);

    std::function<void()> wake_;
    // Of the merger's thread alone:
    std::map<ViewId, OpenFilm> films_;
    std::map<ViewId, std::shared_ptr<const frame::FilmTile>> features_;  // of pictures that are not open yet

    mutable std::mutex mutex_;  // protects what stands below
    std::condition_variable_any changed_;
    std::deque<Task> tasks_;
    std::vector<MergerOutput> output_;
    std::size_t queued_bytes_ = 0;

    // Last: they start when all else is there. The merger's thread ends first, since it feeds the other.
    PictureMaker pictures_;
    std::jthread thread_;
};

}  // namespace tessera::master
