#include "master/display/display_service.h"

#include <algorithm>

#include "master/filter/catalog.h"
#include "master/render/picture_chunks.h"
#include "mediator/display/frustum.h"
#include "mediator/display/validate.h"
#include "mediator/filter/choice.h"
#include "mediator/wire/display_codec.h"

namespace tessera::master {

using session::OutputState;

namespace {

// `shown`: bit i is compositing layer i.
std::string layer_problem(const display::Display& display, std::uint32_t shown) {
    if (shown >> display.layers.size() == 0) return {};
    if (display.layers.empty()) return "the display has no layers to choose from: its file names none";
    std::string text = "the display has no such layer; it has:";
    for (std::size_t i = 0; i < display.layers.size(); ++i)
        text += (i == 0 ? " " : ", ") + std::to_string(i) + " '" + display.layers[i].name + "'";
    return text;
}

std::string first_problem(const display::Display& display) {
    if (const auto found = display::problems(display); !found.empty())
        return found.front() +
               (found.size() > 1 ? " (and " + std::to_string(found.size() - 1) + " more)" : "");
    const auto choice = filter::parse_choice(display.filter, filter::catalog());
    return choice ? filter::why_unavailable(*choice->entry) : std::string(choice.error().what());
}

}  // namespace

DisplayService::DisplayService(const PublishedScene& scene, SessionTable& sessions, Views& renderer,
                               Outbox& outbox, EventSink events)
    : scene_(scene), sessions_(sessions), renderer_(renderer), outbox_(outbox), events_(std::move(events)) {}

std::string DisplayService::open(const scene::BlobPtr& description, std::vector<scene::BlobPtr> content,
                                 TimePoint now) {
    auto decoded = wire::decode_display(description->bytes());
    if (!decoded) return decoded.error().what();
    if (std::string problem = first_problem(*decoded); !problem.empty()) return problem;
    const std::size_t count = decoded->outputs.size();
    const auto interval =
        std::chrono::duration_cast<Duration>(std::chrono::duration<double>(1.0 / decoded->rate));
    // Clients that show an output of the same name keep it.
    std::map<std::string, OutputClient> output_clients;
    if (open_) {
        for (std::size_t i = 0; i < open_->output_clients.size(); ++i) {
            if (open_->output_clients[i])
                output_clients[open_->display.outputs[i].name] = *open_->output_clients[i];
        }
    }
    if (open_) forget();
    view::FollowedCamera camera(scene_.scene(), decoded->camera);
    open_.emplace(Open{.display = std::move(*decoded),
                       .description = scene::reference(*description),
                       .content = std::move(content),
                       .camera = std::move(camera),
                       .lock = FrameLock({}, count, interval),
                       .output_clients = std::vector<std::optional<OutputClient>>(count),
                       .stereo_differences = std::vector<double>(count),
                       .samples = std::vector<std::uint64_t>(count)});
    open_->content.push_back(description);
    events_({wire::Severity::Info, "display '" + open_->display.name + "' is open: " + std::to_string(count) +
                                       (count == 1 ? " output" : " outputs")});
    report_camera();
    renderer_.group().open(open_->display.spp, open_->display.coarsest, scene_.version());
    for (std::size_t i = 0; i < count; ++i) {
        const auto output_client = output_clients.extract(open_->display.outputs[i].name);
        if (output_client.empty()) continue;
        open_->output_clients[i] = output_client.mapped();
        notify_opened(i, 0);
    }
    for (const auto& [name, output_client] : output_clients)
        dismiss(output_client, "the display that is open now has no output '" + name + "'");
    tick(now);
    return {};
}

bool DisplayService::has(const Hash256& blob) const {
    if (!open_) return false;
    return open_->description.hash == blob ||
           std::ranges::any_of(open_->content,
                               [&](const scene::BlobPtr& known) { return known->hash() == blob; });
}

void DisplayService::close() {
    if (!open_) return;
    for (const auto& output_client : open_->output_clients) {
        if (output_client) dismiss(*output_client, "the display was closed");
    }
    forget();
}

void DisplayService::forget() {
    events_({wire::Severity::Info, "display '" + open_->display.name + "' is closed"});
    renderer_.close_group();
    open_.reset();
}

std::string DisplayService::adjust(const session::DisplayAdjustment& request) {
    if (!open_) return "no display is open: open one with tessera display open";
    display::Display adjusted = open_->display;
    if (request.eye_separation) adjusted.eye_separation = *request.eye_separation;
    if (request.zero_parallax) adjusted.zero_parallax = *request.zero_parallax;
    if (request.exposure) adjusted.exposure = *request.exposure;
    if (request.shown_layers) {
        if (std::string problem = layer_problem(adjusted, *request.shown_layers); !problem.empty())
            return problem;
        for (std::size_t i = 0; i < adjusted.layers.size(); ++i)
            adjusted.layers[i].shown = ((*request.shown_layers >> i) & 1u) != 0;
    }
    if (std::string problem = first_problem(adjusted); !problem.empty()) return problem;
    display::Display same_but_exposure = open_->display;
    same_but_exposure.exposure = adjusted.exposure;
    if (same_but_exposure != adjusted) {
        renderer_.group().changed();
    } else if (open_->display.exposure != adjusted.exposure) {
        renderer_.group().resample();  // the same films with another exposure
    }
    open_->display = std::move(adjusted);
    if (request.pattern && open_->pattern != *request.pattern) {
        open_->pattern = *request.pattern;
        for (std::size_t i = 0; i < open_->output_clients.size(); ++i) {
            if (open_->output_clients[i]) notify_opened(i, 0);
        }
    }
    return {};
}

void DisplayService::move_head(const display::Head& head) {
    if (!open_ || open_->display.head == head || !display::has_valid_position(head)) return;
    // Behind a screen there is no frustum: the head stays at the last position from which all screens are visible.
    const display::Display& display = open_->display;
    try {
        for (const display::Output& output : display.outputs) {
            for (const view::Eye eye : display::eyes(output.stereo))
                (void)display::frustum(output.plane, head, eye, display.eye_separation,
                                       display.zero_parallax);
        }
    } catch (const Error&) {
        return;
    }
    open_->display.head = head;
    renderer_.group().changed();
}

std::string DisplayService::join(const SessionRecord& session, const wire::JoinOutput& request,
                                 TimePoint now) {
    if (!open_) return "no display is open yet: open one with tessera display open";
    const auto& outputs = open_->display.outputs;
    const auto found = std::find_if(outputs.begin(), outputs.end(),
                                    [&](const auto& output) { return output.name == request.name; });
    if (found == outputs.end()) {
        std::string names;
        for (const auto& output : outputs) names += (names.empty() ? "" : ", ") + output.name;
        return "the display has no output '" + request.name + "'; it has: " + names;
    }
    const auto index = static_cast<std::size_t>(found - outputs.begin());
    std::optional<OutputClient>& output_client = open_->output_clients[index];
    if (output_client && output_client->session != session.id)
        return "output '" + request.name + "' is shown already, by a process on " + output_client->host +
               ": stop that one first";
    if (!output_client)
        events_({wire::Severity::Info, "output '" + request.name + "' is shown on " + session.hello.host});
    output_client = OutputClient{session.id, session.hello.host, request.request};
    notify_opened(index, request.request);
    present(open_->lock.left(index, now), now);  // its frame in flight is lost
    return {};
}

void DisplayService::dismiss(const OutputClient& output_client, const std::string& reason) {
    if (const SessionRecord* session = sessions_.find(output_client.session))
        outbox_.control(session->control, wire::RequestDone{output_client.request, false, reason});
}

void DisplayService::notify_opened(std::size_t output, std::uint64_t request) {
    OutputClient& output_client = *open_->output_clients[output];
    const SessionRecord* session = sessions_.find(output_client.session);
    if (session == nullptr) return;
    ++output_client.unanswered;
    outbox_.control(session->control,
                    wire::OutputOpened{.request = request,
                                       .output = {.description = open_->description,
                                                  .index = static_cast<std::uint32_t>(output),
                                                  .pattern = open_->pattern}});
}

std::optional<std::size_t> DisplayService::output_of(SessionId session) const {
    if (!open_) return std::nullopt;
    for (std::size_t i = 0; i < open_->output_clients.size(); ++i) {
        if (open_->output_clients[i] && open_->output_clients[i]->session == session) return i;
    }
    return std::nullopt;
}

void DisplayService::left(SessionId session, TimePoint now) {
    while (const auto output = output_of(session)) {
        events_({wire::Severity::Warning, "output '" + open_->display.outputs[*output].name +
                                              "' has disconnected: the others continue without it"});
        open_->output_clients[*output].reset();
        present(open_->lock.left(*output, now), now);
    }
}

void DisplayService::report_camera() {
    if (const auto& carrier = open_->camera.world_from_camera(); !carrier)
        events_({wire::Severity::Warning,
                 "display '" + open_->display.name + "' waits: " + carrier.error().what()});
}

bool DisplayService::scene_changed(const scene::ChangeList& changes) {
    if (!open_ || !open_->camera.follow(changes, scene_.scene())) return false;
    report_camera();
    renderer_.group().changed();
    return open_->camera.world_from_camera().has_value();
}

std::optional<glm::dvec3> DisplayService::head_in_world() const {
    if (!open_ || !open_->camera.world_from_camera()) return std::nullopt;
    const glm::dvec3 head = open_->display.units_per_metre * open_->display.head.position;
    return *open_->camera.world_from_camera() * glm::dvec4(head, 1.0);
}

void DisplayService::add_output(OutputResult&& output, TimePoint now) {
    // Results arrive in order of request; ignores those of an earlier display.
    if (!open_ || open_->in_progress.empty() || open_->in_progress.front().number != output.request.frame)
        return;
    Frame& frame = open_->in_progress.front();
    if (!output.error.empty() && !std::exchange(frame.failed, true))
        events_({wire::Severity::Warning, "a frame of the display is skipped: " + output.error});
    frame.outputs.at(output.request.output) = std::move(output);
    if (--frame.missing > 0) return;
    if (!frame.failed) open_->waiting = std::move(frame);
    open_->in_progress.pop_front();
    send_waiting(now);
}

// Pictures need the client's bulk link, which may connect after its request, and are not ordered with the control
// messages about the display.
void DisplayService::admit() {
    for (std::size_t i = 0; i < open_->output_clients.size(); ++i) {
        const auto& output_client = open_->output_clients[i];
        if (!output_client || output_client->unanswered > 0 ||
            open_->lock.outputs()[i].state != OutputState::Absent)
            continue;
        const SessionRecord* session = sessions_.find(output_client->session);
        if (session != nullptr && session->bulk) open_->lock.joined(i);
    }
}

void DisplayService::send_waiting(TimePoint now) {
    admit();
    if (!open_->lock.free()) return;
    const bool is_new = open_->waiting.has_value();
    if (!is_new && !(open_->latest && open_->lock.has_joining())) return;
    for (std::size_t i = 0; i < open_->output_clients.size(); ++i) {
        const SessionRecord* session =
            open_->output_clients[i] ? sessions_.find(open_->output_clients[i]->session) : nullptr;
        if (session == nullptr) continue;
        if (const auto clock = session->clock.offset(now)) open_->lock.clock_bound(i, clock->bound);
    }
    if (is_new) open_->latest = std::exchange(open_->waiting, std::nullopt);
    const Frame& frame = *open_->latest;
    open_->version = frame.version;
    for (std::size_t i = 0; i < frame.outputs.size(); ++i) {
        open_->samples[i] = frame.outputs[i].samples;
        if (frame.outputs[i].request.stereo_difference)
            open_->stereo_differences[i] = frame.outputs[i].stereo_difference;
    }
    const auto recipients = is_new ? FrameLock::Recipients::All : FrameLock::Recipients::Joining;
    for (const std::size_t output : open_->lock.begin(frame.number, recipients, now)) send(output);
}

void DisplayService::send(std::size_t index) {
    const SessionRecord* session = sessions_.find(open_->output_clients[index]->session);
    if (session == nullptr || !session->bulk) return;
    const Frame& frame = *open_->latest;
    const OutputResult& output = frame.outputs[index];
    const auto eyes = display::eyes(open_->display.outputs[index].stereo);
    for (std::size_t eye = 0; eye < output.eyes.size(); ++eye) {
        const OutputResult::Picture& picture = output.eyes[eye];
        wire::OutputPicture piece{.frame = frame.number,
                                  .eye = eyes[eye],
                                  .eyes = static_cast<std::uint32_t>(eyes.size()),
                                  .version = frame.version,
                                  .camera = output.request.eyes[eye].in_display,
                                  .width = picture.width,
                                  .height = picture.height,
                                  .encoding = output.request.encoding,
                                  .samples = output.samples,
                                  .total = picture.bytes->size()};
        const std::span<const std::byte> bytes(*picture.bytes);
        for (; piece.offset < bytes.size(); piece.offset += PictureChunkBytes) {
            const auto part = next_chunk(bytes, piece.offset);
            piece.data.assign(part.begin(), part.end());
            outbox_.bulk(*session->bulk, piece);
        }
    }
}

void DisplayService::ready(SessionId session, const wire::OutputReady& ready, TimePoint now) {
    const auto output = output_of(session);
    if (!output) return;
    if (ready.frame == 0) {
        std::size_t& unanswered = open_->output_clients[*output]->unanswered;
        if (unanswered > 0) --unanswered;
        return send_waiting(now);
    }
    present(open_->lock.ready(*output, ready.frame, now), now);
}

void DisplayService::present(const std::optional<FrameLock::Present>& present, TimePoint now) {
    if (present) {
        for (const std::size_t output : present->outputs) {
            const SessionRecord* session = open_->output_clients[output]
                                               ? sessions_.find(open_->output_clients[output]->session)
                                               : nullptr;
            if (session == nullptr) continue;
            session::PresentFrame order{.frame = present->frame, .version = open_->version};
            // While the clock offset is unknown: present at once.
            if (const auto clock = session->clock.offset(now)) {
                order.at = (present->at.time_since_epoch() + clock->offset).count();
                order.bound = clock->bound.count();
            }
            outbox_.control(session->control, wire::PresentFrame{order});
        }
    }
    send_waiting(now);
}

void DisplayService::tick(TimePoint now) {
    if (!open_) return;
    const auto before = open_->lock.outputs();
    present(open_->lock.tick(now), now);
    for (std::size_t i = 0; i < before.size(); ++i) {
        if (open_->lock.outputs()[i].late > before[i].late)
            events_({wire::Severity::Warning, "output '" + open_->display.outputs[i].name +
                                                  "' is late: the others continue without it"});
    }
    using enum LockstepGroup::Consumer;
    while (const auto stage = renderer_.next_group_stage(can_take() ? Free : Busy, now)) take(*stage);
    if (renderer_.group().is_restart_due()) renderer_.restart_group(views(), now);
}

TimePoint DisplayService::next_event() const {
    return open_ ? open_->lock.next_event() : TimePoint::max();
}

session::DisplayStatus DisplayService::status(TimePoint now) const {
    if (!open_) return {};
    session::DisplayStatus status{.name = open_->display.name.empty() ? "display" : open_->display.name,
                                  .frames = open_->lock.frames(),
                                  .version = open_->version,
                                  .rate = open_->lock.rate(now),
                                  .outputs = {}};
    for (std::size_t i = 0; i < open_->output_clients.size(); ++i) {
        const FrameLock::Output& output = open_->lock.outputs()[i];
        const bool is_coming = open_->output_clients[i] && output.state == OutputState::Absent;
        status.outputs.push_back({.name = open_->display.outputs[i].name,
                                  .host = open_->output_clients[i] ? open_->output_clients[i]->host : "",
                                  .state = is_coming ? OutputState::Joining : output.state,
                                  .frames = output.frames,
                                  .late = output.late,
                                  .stereo_difference = open_->stereo_differences[i],
                                  .samples = open_->samples[i]});
    }
    return status;
}

}  // namespace tessera::master
