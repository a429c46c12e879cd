// What is under a pixel: one sample of a view that sees nothing but the pixel's middle.
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>

#include "master/render/live_runner.h"

namespace tessera::master {

namespace {

constexpr frame::ChannelSet PickChannels{frame::Channel::Depth, frame::Channel::ObjectIndex,
                                         frame::Channel::Normal};
// Of a pixel's edge: so narrow that where in it the sample falls moves the hit by no more than rounding of
// a float32 distance does.
constexpr double PickWidth = 1e-6;

}  // namespace

void LiveRunner::pick(SessionId session, const wire::Pick& request, Version version, TimePoint) {
    PickTask task{.session = session, .request = request, .version = version, .pass = {}};
    const auto watched = frames_.watched(session, request.number);
    if (!watched) return refuse_pick(task, "this client has no view " + std::to_string(request.number));
    const view::View& seen = views_.at(*watched).view;
    if (request.x >= seen.width || request.y >= seen.height) {
        return refuse_pick(task, "pixel " + std::to_string(request.x) + "," + std::to_string(request.y) +
                                     " is outside the view of " + std::to_string(seen.width) + "x" +
                                     std::to_string(seen.height));
    }
    constexpr std::size_t MaxPicks = 64;
    if (picks_.size() >= MaxPicks) return refuse_pick(task, "too many picks wait: try again later");
    const view::CameraPose& camera = seen.camera;
    const double width = (camera.right - camera.left) / seen.width;
    const double height = (camera.top - camera.bottom) / seen.height;
    const double x = camera.left + (request.x + 0.5) * width, y = camera.top - (request.y + 0.5) * height;
    view::View& view = task.pass.view;
    view.id = ViewId{next_view_};
    next_view_ += MaxPasses;
    view.camera = camera;
    view.camera.lens_radius = 0.0;
    view.camera.left = x - 0.5 * PickWidth * width;
    view.camera.right = x + 0.5 * PickWidth * width;
    view.camera.bottom = y - 0.5 * PickWidth * height;
    view.camera.top = y + 0.5 * PickWidth * height;
    view.width = view.height = 1;
    view.window = {0, 0, 1, 1};
    view.max_bounces = 0;
    view.layers = seen.layers;
    view.channels = PickChannels;
    const bool is_parallel = camera.projection == scene::Projection::Orthographic;
    const glm::dvec3 at(x, y, 0.0), along = is_parallel ? glm::dvec3(0.0, 0.0, -1.0) : glm::dvec3(x, y, -1.0);
    task.along_axis = glm::length(along);
    task.eye = glm::dvec3(camera.world_from_camera * glm::dvec4(is_parallel ? at : glm::dvec3(0.0), 1.0));
    task.direction = glm::normalize(glm::dmat3(camera.world_from_camera) * along);
    begin_pass(task.pass, version);
    picks_.push_back(std::move(task));
}

void LiveRunner::refuse_pick(const PickTask& task, const std::string& problem) {
    if (const SessionRecord* session = sessions_.find(task.session))
        outbox_.control(
            session->control,
            wire::Picked{.request = task.request.request, .version = task.version, .problem = problem});
}

void LiveRunner::take(FilmBlocks&& film) {
    for (PickTask& task : picks_) {
        if (task.pass.view.id != film.view || film.blocks.empty()) continue;
        answer(task, film.blocks.front());
        end(task.pass);
    }
}

void LiveRunner::answer(PickTask& task, const frame::FilmTile& film) {
    wire::Picked picked{.request = task.request.request, .version = task.version};
    const float depth = film.plane(film.channels.first_plane(frame::Channel::Depth))[0];
    if (std::isfinite(depth)) {
        const std::uint32_t object = film.channels.first_plane(frame::Channel::ObjectIndex) + 1;
        const std::uint32_t normal = film.channels.first_plane(frame::Channel::Normal);
        picked.hit = true;
        picked.object = ObjectId{std::bit_cast<std::uint32_t>(film.plane(object)[0])};
        picked.distance = depth * task.along_axis;
        picked.position = task.eye + task.direction * picked.distance;
        picked.normal = {film.plane(normal)[0], film.plane(normal + 1)[0], film.plane(normal + 2)[0]};
    }
    if (const SessionRecord* session = sessions_.find(task.session))
        outbox_.control(session->control, std::move(picked));
}

}  // namespace tessera::master
