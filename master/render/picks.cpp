#include "master/render/picks.h"

#include <bit>
#include <cmath>
#include <glm/geometric.hpp>

namespace tessera::master {

namespace {

constexpr frame::ChannelSet PickChannels{frame::Channel::Depth, frame::Channel::ObjectIndex,
                                         frame::Channel::Normal};
// Part of a pixel's width: so narrow that the sample position moves the hit by less than the rounding of a float32
// distance.
constexpr double PickWidth = 1e-6;

}  // namespace

void Picks::pick(SessionId session, const wire::Pick& request, const view::View* seen, Version version) {
    Task task{.session = session, .request = request, .version = version, .pass = {}};
    if (seen == nullptr) return refuse(task, "this client has no view " + std::to_string(request.number));
    if (request.x >= seen->width || request.y >= seen->height) {
        return refuse(task, "pixel " + std::to_string(request.x) + "," + std::to_string(request.y) +
                                " is outside the view of " + std::to_string(seen->width) + "x" +
                                std::to_string(seen->height));
    }
    constexpr std::size_t MaxPicks = 64;
    if (tasks_.size() >= MaxPicks) return refuse(task, "too many picks wait: try again later");
    aim(task, *seen);
    passes_.begin(task.pass, {.window = task.pass.view.window, .tile = 1, .spp = 1}, {version}, std::nullopt);
    tasks_.push_back(std::move(task));
}

void Picks::aim(Task& task, const view::View& seen) const {
    const view::CameraPose& camera = seen.camera;
    const double width = (camera.right - camera.left) / seen.width;
    const double height = (camera.top - camera.bottom) / seen.height;
    const double x = camera.left + (task.request.x + 0.5) * width;
    const double y = camera.top - (task.request.y + 0.5) * height;
    view::View& view = task.pass.view;
    view.id = ids_.take();
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
}

void Picks::session_left(SessionId session) {
    std::erase_if(tasks_, [&](const Task& task) {
        if (task.session != session) return false;
        passes_.end(task.pass.view.id);
        return true;
    });
}

void Picks::close_all() {
    for (const Task& task : tasks_) passes_.end(task.pass.view.id);
    tasks_.clear();
}

void Picks::follow(Version version) {
    for (Task& task : tasks_) {
        task.version = version;
        passes_.dispatcher.follow(task.pass.view.id, version);
    }
}

void Picks::deal(std::vector<NodeCapacity>& capacities, TimePoint now) {
    for (const Task& task : tasks_) passes_.dispatcher.deal(task.pass.view.id, capacities, now);
}

void Picks::tick() {
    for (Task& task : tasks_) {
        const Scheduler* pass = passes_.dispatcher.find(task.pass.view.id);
        if (pass == nullptr || !pass->complete() || task.copied) continue;
        passes_.film.copy(task.pass.view.id);
        task.copied = true;
    }
}

bool Picks::take(const FilmBlocks& film) {
    const auto task = std::find_if(tasks_.begin(), tasks_.end(), [&](const Task& candidate) {
        return candidate.pass.view.id == film.view;
    });
    if (task == tasks_.end()) return false;
    if (!film.blocks.empty()) {
        answer(*task, film.blocks.front());
        passes_.end(film.view);
        tasks_.erase(task);
    }
    return true;
}

void Picks::refuse(const Task& task, const std::string& problem) {
    if (const SessionRecord* session = sessions_.find(task.session))
        outbox_.control(session->control, wire::Picked{.request = task.request.request,
                                                       .result = {.version = task.version},
                                                       .problem = problem});
}

void Picks::answer(const Task& task, const frame::FilmTile& film) {
    session::PickResult picked{.version = task.version};
    const float depth = film.plane(film.channels.first_plane(frame::Channel::Depth))[0];
    if (std::isfinite(depth)) {
        const std::uint32_t object = film.channels.first_plane(frame::Channel::ObjectIndex) + 1;
        const std::uint32_t normal = film.channels.first_plane(frame::Channel::Normal);
        picked.hit = true;
        picked.object = ObjectId{std::bit_cast<std::uint32_t>(film.plane(object)[0])};
        picked.name = name_of_(picked.object);
        picked.distance = depth * task.along_axis;
        picked.position = task.eye + task.direction * picked.distance;
        picked.normal = {film.plane(normal)[0], film.plane(normal + 1)[0], film.plane(normal + 2)[0]};
    }
    if (const SessionRecord* session = sessions_.find(task.session))
        outbox_.control(session->control,
                        wire::Picked{.request = task.request.request, .result = picked, .problem = {}});
}

}  // namespace tessera::master
