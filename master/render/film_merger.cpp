#include "master/render/film_merger.h"

#include <algorithm>

#include "mediator/wire/envelope.h"

namespace tessera::master {

FilmMerger::FilmMerger(std::function<void()> wake)
    : wake_(std::move(wake)),
      pictures_([this](PictureMaker::Made made) {
          std::visit([this](auto&& result) { put(std::move(result)); }, std::move(made));
      }),
      thread_([this](std::stop_token stop) { run(stop); }) {}

FilmMerger::~FilmMerger() = default;

void FilmMerger::open(ViewId view, std::uint64_t revision, FrameAssembler assembler) {
    enqueue(Open{view, revision, std::make_shared<FrameAssembler>(std::move(assembler))}, 0);
}

void FilmMerger::close(ViewId view) {
    enqueue(Close{view}, 0);
}

void FilmMerger::widen(ViewId view, std::uint64_t revision, frame::ChannelSet channels) {
    enqueue(Widen{view, revision, channels}, 0);
}

void FilmMerger::keep_features(ViewId view, ViewId of_picture) {
    enqueue(KeepFeatures{view, of_picture}, 0);
}

void FilmMerger::push(net::PeerId peer, net::Bytes film_message) {
    const std::size_t bytes = film_message.size();
    enqueue(Film{peer, std::move(film_message)}, bytes);
}

void FilmMerger::deliver(ViewId view, JobId job, std::uint32_t first_tile, std::uint32_t last_tile) {
    enqueue(Deliver{view, job, first_tile, last_tile}, 0);
}

void FilmMerger::copy(ViewId view, JobId job) {
    enqueue(Copy{view, job}, 0);
}

void FilmMerger::reconstruct(JobId job, const view::View& view, wire::PictureEncoding encoding,
                             FilmHash hash) {
    enqueue(Reconstruct{job, view, encoding, hash}, 0);
}

void FilmMerger::make_output(OutputOrder order) {
    enqueue(std::move(order), 0);
}

void FilmMerger::rehearse(JobId job, const view::View& view, wire::PictureEncoding encoding) {
    pictures_.rehearse(job, view, encoding);
}

std::vector<MergerOutput> FilmMerger::take() {
    const std::scoped_lock lock(mutex_);
    return std::exchange(output_, {});
}

std::size_t FilmMerger::queued_bytes() const {
    const std::scoped_lock lock(mutex_);
    return queued_bytes_;
}

void FilmMerger::enqueue(Task task, std::size_t bytes) {
    {
        const std::scoped_lock lock(mutex_);
        tasks_.push_back(std::move(task));
        queued_bytes_ += bytes;
    }
    changed_.notify_one();
}

void FilmMerger::run(std::stop_token stop) {
    while (true) {
        std::unique_lock lock(mutex_);
        if (!changed_.wait(lock, stop, [this] { return !tasks_.empty(); })) return;
        Task task = std::move(tasks_.front());
        tasks_.pop_front();
        lock.unlock();
        std::visit([this](auto& chosen) { perform(chosen); }, task);
        if (const auto* film = std::get_if<Film>(&task)) {
            const std::scoped_lock done(mutex_);
            queued_bytes_ -= film->bytes.size();
        }
    }
}

FilmMerger::OpenFilm* FilmMerger::film(ViewId view) {
    const auto place = films_.find(view);
    return place == films_.end() ? nullptr : &place->second;
}

void FilmMerger::perform(Open& task) {
    OpenFilm opened{.revision = task.revision, .assembler = std::move(task.assembler), .features = {}};
    if (auto features = features_.extract(task.view)) opened.features = std::move(features.mapped());
    films_.insert_or_assign(task.view, std::move(opened));
}

void FilmMerger::perform(Close& task) {
    films_.erase(task.view);
    features_.erase(task.view);
}

void FilmMerger::perform(KeepFeatures& task) {
    if (auto ended = films_.extract(task.view)) {
        features_[task.of_picture] =
            std::make_shared<const frame::FilmTile>(ended.mapped().assembler->whole());
    }
}

void FilmMerger::perform(Widen& task) {
    OpenFilm* opened = film(task.view);
    if (opened == nullptr) return;
    opened->revision = task.revision;
    opened->assembler->widen(task.channels);
}

void FilmMerger::perform(Film& task) {
    MergeReport report{.peer = task.peer};
    auto message = wire::decode_bulk(task.bytes);
    auto* part = message ? std::get_if<wire::FilmPart>(&*message) : nullptr;
    if (part == nullptr) {
        report.malformed = true;
        put(std::move(report));
        return;
    }
    report.unit = part->unit;
    report.view = part->view;
    report.revision = part->revision;
    report.part = part->part;
    report.parts = part->parts;
    report.block = part->film.block;
    report.pixel_samples = part->film.block.count() * part->film.pixel_count();
    report.nonfinite = part->film.nonfinite_samples;
    report.rays = part->rays;
    report.busy = std::chrono::nanoseconds(part->busy_ns);
    OpenFilm* opened = film(part->view);
    report.stale = opened == nullptr || part->revision != opened->revision;
    if (!report.stale) report.result = opened->assembler->insert(std::move(part->film));
    put(std::move(report));
}

void FilmMerger::perform(Deliver& task) {
    const OpenFilm* opened = film(task.view);
    if (opened == nullptr) return;
    for (std::uint32_t tile = task.first; tile < task.last; ++tile) {
        wire::FrameTile frame_tile{.job = task.job,
                                   .index = tile,
                                   .count = opened->assembler->tile_count(),
                                   .film = opened->assembler->merged_tile(tile)};
        put(EncodedTile{task.job, wire::encode(wire::BulkMessage(std::move(frame_tile)))});
    }
}

void FilmMerger::perform(Copy& task) {
    const OpenFilm* opened = film(task.view);
    if (opened != nullptr)
        put(FilmBlocks{task.job, task.view, opened->revision, opened->assembler->blocks()});
}

void FilmMerger::perform(Reconstruct& task) {
    const OpenFilm* opened = film(task.view.id);
    if (opened == nullptr) return;
    pictures_.make({.job = task.job,
                    .film = opened->assembler->whole(),
                    .later = opened->assembler->later(),
                    .features = opened->features,
                    .view = std::move(task.view),
                    .encoding = task.encoding,
                    .hash_film = task.hash == FilmHash::Wanted});
}

void FilmMerger::perform(OutputOrder& task) {
    std::vector<frame::FilmTile> films;
    for (const OutputOrder::EyePicture& eye : task.eyes) {
        for (const view::View& layer : eye.layers) {
            const OpenFilm* opened = film(layer.id);
            if (opened == nullptr || opened->revision != layer.revision) {
                put(MadeOutput{.order = std::move(task),
                               .eyes = {},
                               .error = "its film is gone: the scene changed meanwhile"});
                return;
            }
            films.push_back(opened->assembler->whole());
        }
    }
    pictures_.make(std::move(task), std::move(films));
}

void FilmMerger::put(MergerOutput output) {
    {
        const std::scoped_lock lock(mutex_);
        output_.push_back(std::move(output));
    }
    wake_();
}

}  // namespace tessera::master
