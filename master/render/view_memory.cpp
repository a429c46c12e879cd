#include "master/render/view_memory.h"

#include <algorithm>

#include "master/filter/catalog.h"
#include "master/render/adaptive/filtered_error.h"
#include "master/render/view_request.h"
#include "mediator/picture/noise_map.h"

namespace tessera::master {

namespace {

// Without reading its parameters: this is asked for each edit. Null: there is none of this name.
const filter::Description* denoiser_of(const view::View& view) {
    const std::string_view name = std::string_view(view.filter).substr(0, view.filter.find(':'));
    const auto found = std::ranges::find(
        filter::catalog(), name, [](const filter::FilterEntry& entry) { return entry.description.name; });
    return found == filter::catalog().end() ? nullptr : &found->description;
}

}  // namespace

void ViewMemory::add(const session::ViewRequest& request) {
    bytes_ += film_bytes(request.view);
    const std::size_t window_pixels = request.view.window.pixel_count();
    if (request.has_steps()) {  // a decision reads a copy of the film
        decision_ =
            std::max(decision_, film_bytes(request.view) + picture::NoiseMap::BytesPerPixel * window_pixels);
    }
    const filter::Description* denoiser = denoiser_of(request.view);
    if (request.has_steps() && request.stop.error > 0.0) {
        const double filter = denoiser != nullptr ? denoiser->bytes_per_pixel : 0.0;
        const double error =
            double(window_pixels) * (filter + double(FilteredError::bytes_per_pixel(request.view.channels)));
        decision_ = std::max(decision_, film_bytes(request.view) + static_cast<std::uint64_t>(error));
    }
    if (denoiser == nullptr) return;
    const Rect& window = request.view.window;
    double pixels = double(window.pixel_count());
    const bool is_shared = !denoiser->needs_own_instance();
    if (!is_shared && request.frames == session::Frames::All) {
        for (const int scale : {2, 4, 8}) pixels += double(window.pixel_count()) / (scale * scale);
    } else if (is_shared && !shared_.insert({denoiser->name, window.width, window.height}).second) {
        return;
    }
    bytes_ += static_cast<std::uint64_t>(pixels * denoiser->bytes_per_pixel);
}

}  // namespace tessera::master
