#include "master/picture_maker.h"

#include <algorithm>

#include "mediator/frame/resolve.h"

namespace tessera::master {

PictureMaker::PictureMaker(std::function<void(Made)> done)
    : done_(std::move(done)), thread_([this](std::stop_token stop) { run(stop); }) {}

PictureMaker::~PictureMaker() = default;

void PictureMaker::make(PictureTask task) {
    enqueue(std::move(task));
}

void PictureMaker::rehearse(JobId job, const view::View& view, wire::PictureEncoding encoding) {
    enqueue(Rehearsal{job, view, encoding});
}

void PictureMaker::enqueue(Task task) {
    {
        const std::scoped_lock lock(mutex_);
        tasks_.push_back(std::move(task));
    }
    changed_.notify_one();
}

void PictureMaker::run(std::stop_token stop) {
    while (true) {
        std::unique_lock lock(mutex_);
        if (!changed_.wait(lock, stop, [this] { return !tasks_.empty(); })) return;
        Task task = std::move(tasks_.front());
        tasks_.pop_front();
        lock.unlock();
        done_(std::visit([this](auto& chosen) { return perform(chosen); }, task));
    }
}

PictureMaker::Made PictureMaker::perform(PictureTask& task) {
    const auto [least, most] = std::minmax_element(task.film.counts.begin(), task.film.counts.end());
    Reconstructed made{.job = task.job, .picture = {}, .samples_least = *least, .samples_most = *most};
    made.picture.bytes = std::make_shared<const std::vector<std::byte>>();
    if (task.hash_film) made.film_hash = frame::film_hash(task.film);
    if (task.encoding != wire::PictureEncoding::None) {
        made.picture = reconstructor_.reconstruct({.film = task.film,
                                                   .later = task.later ? &*task.later : nullptr,
                                                   .features = task.features.get()},
                                                  task.view, task.encoding);
    }
    return made;
}

PictureMaker::Made PictureMaker::perform(Rehearsal& task) {
    constexpr std::uint32_t Edge = 256;
    const auto width = std::min(static_cast<std::uint32_t>(task.view.window.width), Edge);
    const auto height = std::min(static_cast<std::uint32_t>(task.view.window.height), Edge);
    const double seconds = reconstructor_.rehearse(task.view, task.encoding, width, height);
    return Rehearsed{task.job, std::uint64_t{width} * height, seconds};
}

}  // namespace tessera::master
