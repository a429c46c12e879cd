#pragma once

#include <condition_variable>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <thread>
#include <variant>
#include <vector>

#include "master/render/adaptive/step.h"
#include "master/render/frame_assembler.h"
#include "master/render/picture_worker.h"
#include "master/render/render_outputs.h"
#include "master/render/schedule/unit_ledger.h"
#include "mediator/net/channel.h"
#include "mediator/wire/envelope.h"

namespace tessera::master {

// The films of all views. Decodes and merges on its own thread, so that the master's event loop is never blocked;
// pictures are reconstructed on another thread (picture_worker.h). One film per pass, under the id of its view.
// Tasks run in order; their results arrive through RenderOutputs.
class FilmStore {
  public:
    explicit FilmStore(RenderOutputs& outputs);
    ~FilmStore();

    // Replaces an older film of the view. `step`: that an adaptive picture is in.
    void open(ViewId view, std::uint64_t revision, FrameAssembler assembler, std::vector<Round> step = {});
    void close(ViewId view);
    // The film continues under another revision, with more channels.
    void add_channels(ViewId view, std::uint64_t revision, frame::ChannelSet channels);
    // Closes the film and retains it as full-size features for upsampling another film's picture.
    void retain_as_features(ViewId view, ViewId of_picture);
    // Film that was admitted (dispatcher.h).
    void push(NodeId node, const wire::FilmHead& head, Admission&& admission, net::Bytes film_message);
    // Tiles [first, last) as messages for a client: merged, or as blocks and what is left of the step.
    enum class TilesAs { Merged, Blocks };
    void deliver(ViewId view, std::uint64_t frame, std::uint32_t first, std::uint32_t last,
                 TilesAs form = TilesAs::Merged);
    void copy(ViewId view);  // results in FilmBlocks, or in nothing when there is no such film

    // The next step of an adaptive picture; results in a StepDecision, or in nothing when there is no such film. Tiles that
    // are closed get no more samples. `error`: the relMSE to reach of the view's filtered picture; 0: as `settings` say.
    void decide(const view::View& view, const AdaptiveSettings& settings, double error,
                std::vector<std::uint32_t> closed_tiles);

    enum class FilmHash { Wanted, NotWanted };
    // Of the film of view.id, which shows `scene`. No result when there is no such film.
    void reconstruct(std::uint64_t frame, const view::View& view, const SceneState& scene,
                     const PictureFormat& format, FilmHash hash);
    // Of the films of all layers of all eyes. Always has a result, with an error when a film is gone.
    void reconstruct_output(OutputRequest request);
    void calibrate(const view::View& view, session::PictureEncoding encoding) {
        pictures_.calibrate(view, encoding);
    }
    // The views [first, last) are closed: discards the history of their filters.
    void forget(ViewId first, ViewId last) { pictures_.forget(first, last); }

    std::size_t queued_bytes() const;

  private:
    struct Open {
        ViewId view;
        std::uint64_t revision;
        std::shared_ptr<FrameAssembler> assembler;
        std::vector<Round> step;
    };
    struct Close {
        ViewId view;
    };
    struct RetainAsFeatures {
        ViewId view, of_picture;
    };
    struct AddChannels {
        ViewId view;
        std::uint64_t revision;
        frame::ChannelSet channels;
    };
    struct Film {
        NodeId node;
        wire::FilmHead head;
        Admission admission;
        net::Bytes bytes;
    };
    struct Deliver {
        ViewId view;
        std::uint64_t frame;
        std::uint32_t first, last;
        TilesAs form;
    };
    struct Copy {
        ViewId view;
    };
    struct Decide {
        view::View view;
        AdaptiveSettings settings;
        double error;
        std::vector<std::uint32_t> closed_tiles;
    };
    struct Reconstruct {
        std::uint64_t frame;
        view::View view;
        SceneState scene;
        PictureFormat format;
        FilmHash hash;
    };
    using Task = std::variant<Open, Close, RetainAsFeatures, AddChannels, Film, Deliver, Copy, Decide,
                              Reconstruct, OutputRequest>;
    struct OpenFilm {
        std::uint64_t revision = 0;
        std::shared_ptr<FrameAssembler> assembler;
        std::shared_ptr<const frame::FilmTile> features;
        std::vector<Round> step;  // that an adaptive picture is in, or the last one
    };

    void enqueue(Task task, std::size_t bytes);
    void run(std::stop_token stop);
    void perform(Open& task);
    void perform(Close& task);
    void perform(RetainAsFeatures& task);
    void perform(AddChannels& task);
    void perform(Film& task);
    void merge(Film& task, MergeReport& report);
    void perform(Deliver& task);
    void deliver_blocks(const OpenFilm& film, std::uint64_t frame, std::uint32_t tile);
    void perform(Copy& task);
    void perform(Decide& task);
    void perform(Reconstruct& task);
    void perform(OutputRequest& task);
    OpenFilm* film(ViewId view);

    RenderOutputs& outputs_;
    // Only used by the store's thread:
    std::map<ViewId, OpenFilm> films_;
    std::map<ViewId, std::shared_ptr<const frame::FilmTile>> features_;  // of pictures that are not open yet
    tbb::task_arena arena_;                                              // of decisions

    mutable std::mutex mutex_;  // protects the members below
    std::condition_variable_any changed_;
    std::deque<Task> tasks_;
    std::size_t queued_bytes_ = 0;

    // Last: they start after everything else is constructed. The store's thread ends first, since it feeds the other.
    PictureWorker pictures_;
    std::jthread thread_;
};

}  // namespace tessera::master
