#include "master/film_merger.h"

#include <algorithm>

#include "mediator/wire/envelope.h"

namespace tessera::master {

FilmMerger::FilmMerger(std::function<void()> wake)
    : wake_(std::move(wake)), thread_([this](std::stop_token stop) { run(stop); }) {}

FilmMerger::~FilmMerger() = default;

void FilmMerger::open(ViewId view, std::uint64_t revision, FrameAssembler assembler) {
    enqueue(Open{view, revision, std::make_shared<FrameAssembler>(std::move(assembler))}, 0);
}

void FilmMerger::close() {
    enqueue(Close{}, 0);
}

void FilmMerger::widen(std::uint64_t revision, frame::ChannelSet channels) {
    enqueue(Widen{revision, channels}, 0);
}

void FilmMerger::keep_features() {
    enqueue(KeepFeatures{}, 0);
}

void FilmMerger::push(net::PeerId peer, net::Bytes film_message) {
    const std::size_t bytes = film_message.size();
    enqueue(Film{peer, std::move(film_message)}, bytes);
}

void FilmMerger::deliver(JobId job, std::uint32_t first_tile, std::uint32_t last_tile) {
    enqueue(Deliver{job, first_tile, last_tile}, 0);
}

void FilmMerger::reconstruct(JobId job, const view::View& view, wire::PictureEncoding encoding) {
    enqueue(Reconstruct{job, view, encoding}, 0);
}

void FilmMerger::rehearse(JobId job, const view::View& view, wire::PictureEncoding encoding) {
    enqueue(Rehearse{{job, view, encoding}}, 0);
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

void FilmMerger::perform(Open& task) {
    view_ = task.view;
    revision_ = task.revision;
    assembler_ = std::move(task.assembler);
}

void FilmMerger::perform(Close&) {
    assembler_.reset();
    features_.reset();
}

void FilmMerger::perform(KeepFeatures&) {
    if (assembler_) features_ = assembler_->whole();
}

void FilmMerger::perform(Widen& task) {
    revision_ = task.revision;
    if (assembler_) assembler_->widen(task.channels);
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
    report.stale = !assembler_ || part->view != view_ || part->revision != revision_;
    if (!report.stale) report.result = assembler_->insert(std::move(part->film));
    put(std::move(report));
}

void FilmMerger::perform(Deliver& task) {
    if (!assembler_) return;
    for (std::uint32_t tile = task.first; tile < task.last; ++tile) {
        wire::FrameTile frame_tile{.job = task.job,
                                   .index = tile,
                                   .count = assembler_->tile_count(),
                                   .film = assembler_->merged_tile(tile)};
        put(EncodedTile{task.job, wire::encode(wire::BulkMessage(std::move(frame_tile)))});
    }
}

void FilmMerger::perform(Reconstruct& task) {
    if (!assembler_) return;
    const frame::FilmTile film = assembler_->whole();
    const auto [least, most] = std::minmax_element(film.counts.begin(), film.counts.end());
    Reconstructed output{.job = task.job, .samples_least = *least, .samples_most = *most};
    const std::optional<frame::FilmTile> later = assembler_->later();
    output.picture = reconstructor_.reconstruct(
        {.film = film, .later = later ? &*later : nullptr, .features = features_ ? &*features_ : nullptr},
        task.view, task.encoding);
    put(std::move(output));
}

// Small, since somebody is waiting, and a tenth of a megapixel at most.
void FilmMerger::perform(Rehearse& task) {
    constexpr std::uint32_t Edge = 256;
    const auto width = std::min(static_cast<std::uint32_t>(task.view.window.width), Edge);
    const auto height = std::min(static_cast<std::uint32_t>(task.view.window.height), Edge);
    const double seconds = reconstructor_.rehearse(task.view, task.encoding, width, height);
    put(Rehearsed{task.job, std::uint64_t{width} * height, seconds});
}

void FilmMerger::put(MergerOutput output) {
    {
        const std::scoped_lock lock(mutex_);
        output_.push_back(std::move(output));
    }
    wake_();
}

}  // namespace tessera::master
