#include "master/render/picture_maker.h"

#include <algorithm>

#include "mediator/frame/resolve.h"

namespace tessera::master {

void PictureMaker::make(PictureTask task) {
    thread_.post(
        [this, task = std::make_shared<PictureTask>(std::move(task))] { outputs_.put(made(*task)); });
}

void PictureMaker::make(OutputOrder order, std::vector<frame::FilmTile> films) {
    thread_.post([this, order = std::move(order),
                  films = std::make_shared<std::vector<frame::FilmTile>>(std::move(films))] {
        outputs_.put(make_output(order, *films, reconstructor_));
    });
}

void PictureMaker::rehearse(const view::View& view, session::PictureEncoding encoding) {
    thread_.post([this, view, encoding] {
        constexpr std::uint32_t Edge = 256;
        const auto width = std::min(static_cast<std::uint32_t>(view.window.width), Edge);
        const auto height = std::min(static_cast<std::uint32_t>(view.window.height), Edge);
        const double seconds = reconstructor_.rehearse(view, encoding, width, height);
        outputs_.put(Rehearsed{view.id, std::uint64_t{width} * height, seconds});
    });
}

void PictureMaker::forget(ViewId first, ViewId last) {
    thread_.post([this, first, last] { reconstructor_.forget(first, last); });
}

Reconstructed PictureMaker::made(const PictureTask& task) {
    const auto [least, most] = std::minmax_element(task.film.counts.begin(), task.film.counts.end());
    Reconstructed made{.frame = task.frame, .picture = {}, .samples_least = *least, .samples_most = *most};
    made.picture.bytes = std::make_shared<const std::vector<std::byte>>();
    if (task.hash_film) made.film_hash = frame::film_hash(task.film);
    if (task.format.encoding != session::PictureEncoding::None) {
        made.picture = reconstructor_.reconstruct({.film = task.film,
                                                   .later = task.later ? &*task.later : nullptr,
                                                   .features = task.features.get()},
                                                  task.view, task.version, task.format);
    }
    return made;
}

}  // namespace tessera::master
