#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "master/peers/encoded_scene.h"
#include "master/render/adaptive/step.h"
#include "master/render/frame_assembler.h"
#include "master/render/output_reconstruction.h"
#include "master/render/reconstruction.h"
#include "mediator/net/channel.h"

namespace tessera::master {

// The result of merging one film message.
struct MergeReport {
    NodeId node;  // that sent it
    UnitId unit;
    ViewId view;
    std::uint64_t revision = 0;
    std::uint64_t bytes = 0;  // of the message
    std::uint32_t tile = 0;   // index in its pass
    frame::SampleBlock block;
    std::uint32_t units = 0;  // complete with it
    std::uint64_t pixel_samples = 0, nonfinite = 0, rays = 0;
    Duration busy{};
    FrameAssembler::Result result;
    std::optional<Hash256> bits{};  // of its film, if Admission::use asks for it
    bool stale = false;             // of a view or revision that is not being assembled
    std::string problem;            // not empty: its content is damaged or impossible
    std::string failure{};  // not empty: the master could not merge it, most likely for want of memory
};
// One tile of a frame, encoded for a client: merged, or one of its blocks.
struct EncodedTile {
    std::uint64_t frame = 0;
    net::Bytes bytes;
    bool ends_tile = true;
};
// The film of a view, unmerged: the blocks of all tiles.
struct FilmBlocks {
    ViewId view;
    std::uint64_t revision = 0;
    std::vector<frame::FilmTile> blocks;
};
// The picture of a frame, or why there is none.
struct Reconstructed {
    std::uint64_t frame = 0;
    Reconstruction picture;
    std::uint64_t min_samples = 0, max_samples = 0;
    std::optional<Hash256> film_hash;
};
// How long a synthetic picture took in the configuration of a view.
struct CalibrationResult {
    ViewId view;
    std::uint64_t pixels = 0;
    double seconds = 0.0;
};
// What an adaptive pass needs next.
struct StepDecision {
    ViewId view;
    std::uint64_t revision = 0;
    Step step;
};
// A task of a rendering thread failed for a reason that is not in its input: most likely there was no memory for it.
struct TaskFailure {
    std::string text;
};
// An edit that was applied on another thread is done; see scene/authority_thread.h.
struct EditDone {};
using RenderOutput = std::variant<MergeReport, EncodedTile, FilmBlocks, Reconstructed, CalibrationResult,
                                  StepDecision, OutputResult, EncodedScene, EditDone, TaskFailure>;

// Results of the threads that merge film and reconstruct pictures, for the event loop that owns the channel: each
// result wakes it. Thread-safe.
class RenderOutputs {
  public:
    explicit RenderOutputs(net::Channel& loop) : loop_(loop) {}

    void put(RenderOutput output) {
        {
            const std::scoped_lock lock(mutex_);
            outputs_.push_back(std::move(output));
        }
        loop_.wake();
    }
    std::vector<RenderOutput> take() {
        const std::scoped_lock lock(mutex_);
        return std::exchange(outputs_, {});
    }

  private:
    net::Channel& loop_;
    std::mutex mutex_;  // protects outputs_
    std::vector<RenderOutput> outputs_;
};

}  // namespace tessera::master
