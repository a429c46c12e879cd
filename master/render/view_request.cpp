#include "master/render/view_request.h"

#include <algorithm>
#include <cmath>

#include "master/filter/catalog.h"
#include "master/render/adaptive/filtered_error.h"
#include "mediator/filter/choice.h"
#include "mediator/net/channel.h"

namespace tessera::master {

namespace {

constexpr std::uint32_t MaxEdge = 65536;
constexpr std::uint64_t MaxPixels = std::uint64_t{1} << 28;
constexpr std::uint32_t SmallestTile = 8;  // limits the number of tiles of a view to some millions
constexpr std::size_t MaxName = 128;
constexpr Duration LongestTime = std::chrono::hours(24 * 365);  // sums with it stay within a TimePoint

bool finite(const view::CameraPose& camera) {
    for (int column = 0; column < 4; ++column) {
        for (int row = 0; row < 4; ++row) {
            if (!std::isfinite(camera.world_from_camera[column][row])) return false;
        }
    }
    for (const glm::dmat4& step : camera.motion) {
        for (int column = 0; column < 4; ++column) {
            if (!glm::all(glm::lessThan(glm::abs(step[column]), glm::dvec4(1e15)))) return false;
        }
    }
    return std::isfinite(camera.left) && std::isfinite(camera.right) && std::isfinite(camera.bottom) &&
           std::isfinite(camera.top) && camera.left < camera.right && camera.bottom < camera.top;
}

std::string problem_of(const view::CameraPose& camera) {
    constexpr double WidestLens = 1e6, NearestFocus = 1e-6, Farthest = 1e15;  // m; ratios stay within floats
    if (camera.motion.size() > scene::MaxMotion)
        return "the camera moves in more than " + std::to_string(scene::MaxMotion) + " steps";
    if (!finite(camera)) return "the camera is not finite or has an empty frustum";
    if (!(camera.lens_radius >= 0.0 && camera.lens_radius <= WidestLens))
        return "the lens radius is not between 0 and 1e6 m";
    if (camera.lens_radius > 0.0 &&
        !(camera.focus_distance >= NearestFocus && camera.focus_distance <= Farthest))
        return "the focus distance is not between 1e-6 and 1e15 m";
    const double edge = std::max({-camera.left, camera.right, -camera.bottom, camera.top});
    if (camera.projection == scene::Projection::Orthographic && edge > Farthest)
        return "an orthographic view is wider than 1e15 m";
    return {};
}

}  // namespace

std::string problem_of(const view::DisplayTransform& transform) {
    const bool is_fine = !transform.exposure || std::fabs(*transform.exposure) <= view::MaxExposure;
    return is_fine ? std::string() : "the exposure is not between -60 and 60 EV";
}

std::string problem_of(const session::ViewRequest& request) {
    const view::View& view = request.view;
    if (view.width == 0 || view.height == 0 || view.width > MaxEdge || view.height > MaxEdge) {
        return "picture size " + std::to_string(view.width) + "x" + std::to_string(view.height) +
               " is not between 1x1 and 65536x65536";
    }
    const Rect whole{0, 0, static_cast<std::int32_t>(view.width), static_cast<std::int32_t>(view.height)};
    if (view.window.empty() || intersection(view.window, whole) != view.window) {
        return "the crop window reaches outside the picture: choose one inside it";
    }
    if (view.window.pixel_count() > MaxPixels) return "the window has more than 2^28 pixels: crop it";
    if (std::string problem = problem_of(view.camera); !problem.empty()) return problem;
    if (std::string problem = problem_of(request.display_transform); !problem.empty()) return problem;
    if (view.channels.empty()) return "no channel is requested: request color at least";
    if (!(view.pixel_filter.radius > 0.0f) || view.pixel_filter.radius > 16.0f) {
        return "the pixel filter's radius is not between 0 and 16 pixels";
    }
    const session::StopRule& stop = request.stop;
    if (stop.spp == 0 || stop.spp > session::MaxSamplesPerPixel)
        return "samples per pixel are not between 1 and 2^31";
    if (!(stop.noise >= 0.0 && stop.noise <= 1e6)) return "the noise to reach is not between 0 and 1e6";
    if (!(stop.error >= 0.0 && stop.error <= 1e6)) return "the error to reach is not between 0 and 1e6";
    if (stop.noise > 0.0 && stop.error > 0.0)
        return "a view can stop at a noise or at an error, not at both: leave one out";
    if (stop.has_goal() && request.frames == session::Frames::All)
        return "only views that deliver their last picture can stop at a noise or an error";
    if (request.film_state && (!request.film || request.frames == session::Frames::All))
        return "only the film of a view that delivers its last picture can be asked for as blocks";
    if (request.name.size() > MaxName) return "the view's name is longer than 128 bytes";
    if (request.tile != 0 && request.tile < SmallestTile) return "tiles must be at least 8 pixels wide";
    const auto filter = filter::parse_choice(view.filter, filter::catalog());
    if (!filter) return filter.error().what();
    if (stop.error > 0.0) {
        if (std::string why = filter::why_no_error_estimate(*filter); !why.empty())
            return "the error of its picture cannot be estimated: " + why;
    }
    if (request.reproducible) {
        if (std::string why = filter::why_not_reproducible(*filter->entry); !why.empty()) return why;
    }
    if (std::string why = filter::why_unavailable(*filter->entry); !why.empty()) return why;
    const bool has_picture = request.picture != session::PictureEncoding::None;
    if (request.frames == session::Frames::Last && !has_picture && !request.film) {
        return "neither a picture nor the film is requested: request one of them";
    }
    if (stop.budget < Duration::zero()) return "the time budget is negative";
    if (std::max(stop.budget, stop.time_limit) > LongestTime)
        return "the time limit or budget is longer than a year";
    if (stop.has_budget() && !has_picture) return "a time budget needs a picture: request one";
    if (stop.adapts_size && (request.film || !stop.has_budget())) {
        return "only a picture with a time budget and without its film can adapt its size";
    }
    if (stop.time_limit < Duration::zero()) return "the time limit is negative";
    if (request.wait_limit < Duration::zero()) return "the time to wait for nodes is negative";
    return {};
}

std::string why_unavailable(const view::View& view) {
    const auto filter = filter::parse_choice(view.filter, filter::catalog());
    return filter ? filter::why_unavailable(*filter->entry) : std::string();
}

void complete(view::View& view) {
    const auto filter = filter::parse_choice(view.filter, filter::catalog());
    view.channels = view.channels | filter::wanted_channels(*filter, view.channels);
    if (view.transparent_background) view.channels.insert(frame::Channel::Alpha);
    const view::PathClass wanted = filter->entry->description.path_class;
    if (wanted != view::PathClass::Indirect) view.path_class = wanted;
}

bool has_noise(const view::View& view) {
    return view.renderer == view::Renderer::PathTracing && view.channels.contains(frame::Channel::Radiance);
}

void complete(session::ViewRequest& request) {
    complete(request.view);
    if (request.frames == session::Frames::All && !has_noise(request.view)) request.stop.uniform = true;
    if (!request.has_steps()) return;
    request.view.channels.insert(frame::Channel::Radiance);
    request.view.channels.insert(frame::Channel::BlockVariance);
    if (request.stop.error > 0.0) request.view.channels = request.view.channels | ErrorEstimateChannels;
}

view::View feature_view(const view::View& view) {
    view::View features = view;
    features.filter.clear();
    features.channels = {frame::Channel::Albedo, frame::Channel::Normal, frame::Channel::Depth};
    if (view.channels.contains(frame::Channel::Alpha)) features.channels.insert(frame::Channel::Alpha);
    return features;
}

view::View scaled_view(const view::View& view, std::uint32_t scale) {
    const auto part = [&](std::int32_t edge) { return std::max(1, (edge + int(scale) - 1) / int(scale)); };
    view::View small = view;
    const Rect& window = view.window;
    // Uses the frustum of the crop window, so that the crop need not be aligned to the scaled pixels.
    const auto along = [](double a, double b, double t) { return a + (b - a) * t; };
    const view::CameraPose& camera = view.camera;
    small.camera.left = along(camera.left, camera.right, double(window.x) / view.width);
    small.camera.right = along(camera.left, camera.right, double(window.right()) / view.width);
    small.camera.top = along(camera.top, camera.bottom, double(window.y) / view.height);
    small.camera.bottom = along(camera.top, camera.bottom, double(window.bottom()) / view.height);
    small.window = {0, 0, part(window.width), part(window.height)};
    small.width = static_cast<std::uint32_t>(small.window.width);
    small.height = static_cast<std::uint32_t>(small.window.height);
    for (const frame::Channel channel :
         {frame::Channel::Albedo, frame::Channel::Normal, frame::Channel::Depth}) {
        small.channels.insert(channel);
    }
    return small;
}

std::string cost_key(const session::ViewRequest& request) {
    return request.view.filter + " as " + std::to_string(static_cast<int>(request.picture)) +
           " of channels " + std::to_string(request.view.channels.words()[0]) + " " +
           std::to_string(request.view.channels.words()[1]);
}

std::uint32_t choose_tile_edge(const view::View& view, std::uint32_t asked) {
    constexpr std::uint32_t Large = 64, Small = 32, EnoughTiles = 64;
    constexpr std::uint32_t Drawn = 128;  // every tile rasterises all geometry in it
    std::uint32_t edge = asked;
    if (edge == 0) edge = view.window.pixel_count() >= EnoughTiles * Large * Large ? Large : Small;
    if (asked == 0 && view.renderer == view::Renderer::Raster) edge = Drawn;
    const std::size_t bytes_per_pixel = 4 * (view.channels.plane_count() + 1);
    const auto limit =
        static_cast<std::uint32_t>(std::sqrt(double(net::BulkLimit - 4096) / double(bytes_per_pixel)));
    return std::clamp(edge, 1u, limit);
}

}  // namespace tessera::master
