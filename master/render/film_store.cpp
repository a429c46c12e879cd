#include "master/render/film_store.h"

#include <algorithm>
#include <functional>

#include "master/render/adaptive/filtered_error.h"
#include "master/render/adaptive/saved_step.h"
#include "mediator/base/float_mode.h"
#include "mediator/frame/resolve.h"
#include "mediator/wire/film_state_codec.h"

namespace tessera::master {

FilmStore::FilmStore(RenderOutputs& outputs)
    : outputs_(outputs), pictures_(outputs), thread_([this](std::stop_token stop) { run(stop); }) {}

FilmStore::~FilmStore() = default;

void FilmStore::open(ViewId view, std::uint64_t revision, FrameAssembler assembler, std::vector<Round> step) {
    enqueue(Open{view, revision, std::make_shared<FrameAssembler>(std::move(assembler)), std::move(step)}, 0);
}

void FilmStore::close(ViewId view) {
    enqueue(Close{view}, 0);
}

void FilmStore::add_channels(ViewId view, std::uint64_t revision, frame::ChannelSet channels) {
    enqueue(AddChannels{view, revision, channels}, 0);
}

void FilmStore::retain_as_features(ViewId view, ViewId of_picture) {
    enqueue(RetainAsFeatures{view, of_picture}, 0);
}

void FilmStore::push(NodeId node, const wire::FilmHead& head, Admission&& admission,
                     net::Bytes film_message) {
    const std::size_t bytes = film_message.size();
    enqueue(Film{node, head, std::move(admission), std::move(film_message)}, bytes);
}

void FilmStore::deliver(ViewId view, std::uint64_t frame, std::uint32_t first, std::uint32_t last,
                        TilesAs form) {
    enqueue(Deliver{view, frame, first, last, form}, 0);
}

void FilmStore::copy(ViewId view) {
    enqueue(Copy{view}, 0);
}

void FilmStore::decide(const view::View& view, const AdaptiveSettings& settings, double error,
                       std::vector<std::uint32_t> closed_tiles) {
    enqueue(Decide{view, settings, error, std::move(closed_tiles)}, 0);
}

void FilmStore::reconstruct(std::uint64_t frame, const view::View& view, const SceneState& scene,
                            const PictureFormat& format, FilmHash hash) {
    enqueue(Reconstruct{frame, view, scene, format, hash}, 0);
}

void FilmStore::reconstruct_output(OutputRequest request) {
    enqueue(std::move(request), 0);
}

std::size_t FilmStore::queued_bytes() const {
    const std::scoped_lock lock(mutex_);
    return queued_bytes_;
}

void FilmStore::enqueue(Task task, std::size_t bytes) {
    {
        const std::scoped_lock lock(mutex_);
        tasks_.push_back(std::move(task));
        queued_bytes_ += bytes;
    }
    changed_.notify_one();
}

void FilmStore::run(std::stop_token stop) {
    const StandardFloatMode mode;
    while (true) {
        std::unique_lock lock(mutex_);
        if (!changed_.wait(lock, stop, [this] { return !tasks_.empty(); })) return;
        Task task = std::move(tasks_.front());
        tasks_.pop_front();
        lock.unlock();
        try {
            std::visit([this](auto& chosen) { perform(chosen); }, task);
        } catch (const std::exception& error) {
            outputs_.put(TaskFailure{std::string("a task of the film store failed: ") + error.what()});
            // The view ends with the samples that it has, instead of waiting for ever.
            if (const auto* decide = std::get_if<Decide>(&task))
                outputs_.put(StepDecision{decide->view.id, decide->view.revision, {}});
        }
        if (const auto* film = std::get_if<Film>(&task)) {
            const std::scoped_lock done(mutex_);
            queued_bytes_ -= film->bytes.size();
        }
    }
}

FilmStore::OpenFilm* FilmStore::film(ViewId view) {
    const auto found = films_.find(view);
    return found == films_.end() ? nullptr : &found->second;
}

void FilmStore::perform(Open& task) {
    OpenFilm opened{.revision = task.revision,
                    .assembler = std::move(task.assembler),
                    .features = {},
                    .step = std::move(task.step)};
    if (auto features = features_.extract(task.view)) opened.features = std::move(features.mapped());
    films_.insert_or_assign(task.view, std::move(opened));
}

void FilmStore::perform(Close& task) {
    films_.erase(task.view);
    features_.erase(task.view);
}

void FilmStore::perform(RetainAsFeatures& task) {
    if (auto ended = films_.extract(task.view)) {
        features_[task.of_picture] =
            std::make_shared<const frame::FilmTile>(ended.mapped().assembler->whole());
    }
}

void FilmStore::perform(AddChannels& task) {
    OpenFilm* opened = film(task.view);
    if (opened == nullptr) return;
    opened->revision = task.revision;
    opened->assembler->add_channels(task.channels);
}

void FilmStore::perform(Film& task) {
    MergeReport report{.node = task.node,
                       .unit = task.head.unit,
                       .view = task.head.view,
                       .revision = task.head.revision,
                       .bytes = task.bytes.size(),
                       .tile = task.admission.tile,
                       .block = task.head.block,
                       .problem = {}};
    try {
        merge(task, report);
    } catch (const std::exception& error) {
        report.failure = error.what();
    }
    outputs_.put(std::move(report));
}

void FilmStore::merge(Film& task, MergeReport& report) {
    auto message = wire::decode_bulk(task.bytes);
    auto* part = message ? std::get_if<wire::FilmPart>(&*message) : nullptr;
    if (part == nullptr) {
        report.problem = message ? "not film" : message.error().what();
        return;
    }
    report.pixel_samples = part->film.block.count() * part->film.pixel_count();
    report.nonfinite = part->film.nonfinite_samples;
    report.units = part->units;
    report.rays = part->rays;
    report.busy = std::chrono::nanoseconds(part->busy_ns);
    if (task.admission.use != Admission::Use::Merge) report.bits = frame::film_hash(part->film);
    if (task.admission.use == Admission::Use::Compare) return;
    OpenFilm* opened = film(part->view);
    report.stale = opened == nullptr || part->revision != opened->revision;
    if (!report.stale)
        report.result = opened->assembler->insert(std::move(part->film), task.admission.replaceable);
}

void FilmStore::perform(Deliver& task) {
    const OpenFilm* opened = film(task.view);
    if (opened == nullptr) return;
    for (std::uint32_t tile = task.first; tile < task.last; ++tile) {
        if (task.form == TilesAs::Blocks) {
            deliver_blocks(*opened, task.frame, tile);
            continue;
        }
        wire::FrameTile frame_tile{.frame = task.frame,
                                   .index = tile,
                                   .count = opened->assembler->tile_count(),
                                   .film = opened->assembler->merged_tile(tile)};
        outputs_.put(EncodedTile{task.frame, wire::encode(wire::BulkMessage(std::move(frame_tile)))});
    }
}

void FilmStore::deliver_blocks(const OpenFilm& film, std::uint64_t frame, std::uint32_t tile) {
    const FrameAssembler& assembler = *film.assembler;
    std::vector<frame::FilmTile> blocks = assembler.blocks(tile);
    const std::size_t count = blocks.size();
    for (const frame::WantedSamples& wanted : wanted_samples(film.step, assembler, tile))
        blocks.push_back(wire::without_samples(wanted, blocks.front().channels));
    // No samples at all.
    if (blocks.empty()) blocks.push_back(assembler.merged_tile(tile));
    for (std::size_t i = 0; i < blocks.size(); ++i) {
        wire::FilmBlock block{.frame = frame,
                              .index = tile,
                              .count = assembler.tile_count(),
                              .left = static_cast<std::uint32_t>(blocks.size() - 1 - i),
                              .is_wanted = i >= count,
                              .film = std::move(blocks[i])};
        const bool ends_tile = block.left == 0;
        outputs_.put(EncodedTile{frame, wire::encode(wire::BulkMessage(std::move(block))), ends_tile});
    }
}

void FilmStore::perform(Copy& task) {
    const OpenFilm* opened = film(task.view);
    if (opened != nullptr) outputs_.put(FilmBlocks{task.view, opened->revision, opened->assembler->blocks()});
}

void FilmStore::perform(Decide& task) {
    OpenFilm* opened = film(task.view.id);
    if (opened == nullptr || opened->revision != task.view.revision) return;
    const FrameAssembler& assembler = *opened->assembler;
    std::vector<std::uint8_t> doublings = assembler.doublings();
    const frame::FilmTile film = assembler.whole();
    for (const std::uint32_t tile : task.closed_tiles) {
        const Rect& rect = assembler.tiles()[tile];
        for (std::int32_t row = 0; row < rect.height; ++row)
            std::fill_n(doublings.begin() + std::ptrdiff_t{rect.y + row - film.rect.y} * film.rect.width +
                            (rect.x - film.rect.x),
                        rect.width, std::uint8_t{255});
    }
    const ErrorGoal goal{task.view, task.error};
    Step step = task.error > 0.0
                    ? next_step_to(goal, film, doublings, assembler.tiles(), task.settings, arena_)
                    : next_step(film, doublings, assembler.tiles(), task.settings, &arena_);
    opened->step = step.rounds;
    outputs_.put(StepDecision{task.view.id, task.view.revision, std::move(step)});
}

void FilmStore::perform(Reconstruct& task) {
    const OpenFilm* opened = film(task.view.id);
    if (opened == nullptr) return;
    pictures_.make({.frame = task.frame,
                    .film = opened->assembler->whole(),
                    .later = opened->assembler->later(),
                    .features = opened->features,
                    .view = std::move(task.view),
                    .scene = task.scene,
                    .format = task.format,
                    .hash_film = task.hash == FilmHash::Wanted});
}

void FilmStore::perform(OutputRequest& task) {
    std::vector<frame::FilmTile> films;
    for (const OutputRequest::EyePicture& eye : task.eyes) {
        for (const view::View& layer : eye.layers) {
            const OpenFilm* opened = film(layer.id);
            if (opened == nullptr || opened->revision != layer.revision) {
                outputs_.put(OutputResult{.request = std::move(task),
                                          .eyes = {},
                                          .error = "its film was discarded: the scene has changed"});
                return;
            }
            films.push_back(opened->assembler->whole());
        }
    }
    pictures_.make(std::move(task), std::move(films));
}

}  // namespace tessera::master
