#include "master/render/picture_worker.h"

#include <algorithm>

#include "mediator/frame/resolve.h"

namespace tessera::master {

void PictureWorker::make(PictureTask task) {
    thread_.post([this, task = std::make_shared<PictureTask>(std::move(task))] {
        Reconstructed result{.frame = task->frame, .picture = {}};
        try {
            result = reconstruct(*task);
        } catch (const std::exception& error) {
            result.picture.error = std::string("the picture failed: ") + error.what();
        }
        outputs_.put(std::move(result));
    });
}

void PictureWorker::make(OutputRequest request, std::vector<frame::FilmTile> films) {
    post("the picture of an output",
         [this, request = std::move(request),
          films = std::make_shared<std::vector<frame::FilmTile>>(std::move(films))] {
             outputs_.put(reconstruct_output(request, *films, reconstructor_));
         });
}

void PictureWorker::calibrate(const view::View& view, session::PictureEncoding encoding) {
    post("timing a filter", [this, view, encoding] {
        constexpr std::uint32_t Edge = 256;
        const auto width = std::min(static_cast<std::uint32_t>(view.window.width), Edge);
        const auto height = std::min(static_cast<std::uint32_t>(view.window.height), Edge);
        const double seconds = reconstructor_.calibrate(view, encoding, width, height);
        outputs_.put(CalibrationResult{view.id, std::uint64_t{width} * height, seconds});
    });
}

void PictureWorker::forget(ViewId first, ViewId last) {
    thread_.post([this, first, last] { reconstructor_.forget(first, last); });
}

void PictureWorker::post(const char* what, std::function<void()> task) {
    thread_.post([this, what, task = std::move(task)] {
        try {
            task();
        } catch (const std::exception& error) {
            outputs_.put(TaskFailure{std::string(what) + " failed: " + error.what()});
        }
    });
}

Reconstructed PictureWorker::reconstruct(const PictureTask& task) {
    const auto [least, most] = std::minmax_element(task.film.counts.begin(), task.film.counts.end());
    Reconstructed result{.frame = task.frame, .picture = {}, .min_samples = *least, .max_samples = *most};
    result.picture.bytes = std::make_shared<const std::vector<std::byte>>();
    if (task.hash_film) result.film_hash = frame::film_hash(task.film);
    if (task.format.encoding != session::PictureEncoding::None) {
        result.picture = reconstructor_.reconstruct({.film = task.film,
                                                     .later = task.later ? &*task.later : nullptr,
                                                     .features = task.features.get()},
                                                    task.view, task.scene, task.format);
    }
    return result;
}

}  // namespace tessera::master
