#pragma once

#include <condition_variable>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <thread>
#include <variant>
#include <vector>

#include "master/render/frame_assembler.h"
#include "master/render/picture_maker.h"
#include "master/render/render_outputs.h"
#include "mediator/net/channel.h"

namespace tessera::master {

// The films of all views: decodes and merges on a thread of its own, so that the loop that keeps heartbeats
// never does, and has pictures of them made on another. One film a pass, under the id of its view. Tasks run
// in the order given; what they bring forth comes through RenderOutputs.
class FilmStore {
  public:
    explicit FilmStore(RenderOutputs& outputs);
    ~FilmStore();

    void open(ViewId view, std::uint64_t revision, FrameAssembler assembler);  // replaces an older film of it
    void close(ViewId view);
    // The film goes on under another revision, with more channels.
    void widen(ViewId view, std::uint64_t revision, frame::ChannelSet channels);
    // The film ends here: it has the full size, for upsampling the picture of another one.
    void keep_features(ViewId view, ViewId of_picture);
    void push(net::PeerId peer, net::Bytes film_message);
    // Tiles [first, last) as messages for a client.
    void deliver(ViewId view, std::uint64_t frame, std::uint32_t first, std::uint32_t last);
    void copy(ViewId view);  // FilmBlocks, or nothing when there is no such film

    enum class FilmHash { Wanted, NotWanted };
    // Of the film of view.id, which shows `version`. Nothing comes when there is no such film.
    void reconstruct(std::uint64_t frame, const view::View& view, Version version,
                     const PictureFormat& format, FilmHash hash);
    // Of the films of all layers of all eyes. Always comes; with an error when a film is gone.
    void make_output(OutputOrder order);
    void rehearse(const view::View& view, session::PictureEncoding encoding) {
        pictures_.rehearse(view, encoding);
    }
    // The views [first, last) are gone for good, and with them what their filters remember.
    void forget(ViewId first, ViewId last) { pictures_.forget(first, last); }

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
        std::uint64_t frame;
        std::uint32_t first, last;
    };
    struct Copy {
        ViewId view;
    };
    struct Reconstruct {
        std::uint64_t frame;
        view::View view;
        Version version;
        PictureFormat format;
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

    RenderOutputs& outputs_;
    // Of the store's thread alone:
    std::map<ViewId, OpenFilm> films_;
    std::map<ViewId, std::shared_ptr<const frame::FilmTile>> features_;  // of pictures that are not open yet

    mutable std::mutex mutex_;  // protects what stands below
    std::condition_variable_any changed_;
    std::deque<Task> tasks_;
    std::size_t queued_bytes_ = 0;

    // Last: they start when all else is there. The store's thread ends first, since it feeds the other.
    PictureMaker pictures_;
    std::jthread thread_;
};

}  // namespace tessera::master
