// The views of a session: requests, cameras, frames and results.
#include "client/session_exchange.h"
#include "mediator/wire/film_state_codec.h"

namespace tessera::client {

void Session::Implementation::request(std::uint64_t number, wire::RequestView&& request) {
    request.number = number;
    progress.erase(number);
    ended_views.erase(number);
    stopping.erase(number);
    const bool is_new = !views.contains(number);
    views.insert_or_assign(number, request);  // its first messages may arrive before the answer
    try {
        send_and_confirm(request);
    } catch (const Error&) {
        if (is_new) forget_view(number);
        throw;
    }
}

void Session::Implementation::forget_view(std::uint64_t number) {
    views.erase(number);
    films.erase(number);
    stopping.erase(number);
    progress.erase(number);
    ended_views.erase(number);
    frames.erase(number);
}

void Session::request_view(std::uint64_t number, const session::ViewRequest& request) {
    implementation_->request(number, {.wanted = request});
}

void Session::continue_view(std::uint64_t number, const session::ViewRequest& request,
                            const EarlierFilm& earlier) {
    Implementation& self = *implementation_;
    const scene::BlobPtr film = self.blobs->insert(wire::encode(earlier.film));
    self.films[number] = film;
    self.request(number, {.wanted = request,
                          .earlier = wire::EarlierFilm{scene::reference(*film), earlier.scene_hash,
                                                       earlier.render_revision, earlier.kind}});
}

void Session::share_view(std::uint64_t number, const session::ViewRequest& request) {
    implementation_->request(number, {.wanted = request, .share = true});
}

void Session::set_camera(std::uint64_t number, const view::CameraPose& camera) {
    Implementation& self = *implementation_;
    const auto known = self.views.find(number);
    if (known == self.views.end() || known->second.share)
        throw Error(ErrorCode::InvalidInput, "view " + std::to_string(number) +
                                                 " was not requested by this session: request it first");
    known->second.wanted.view.camera = camera;
    known->second.earlier.reset();  // its film is of the other camera
    if (self.state == Implementation::State::Joined) self.link.send(known->second);
}

void Session::stop_view(std::uint64_t number) {
    Implementation& self = *implementation_;
    if (!self.views.contains(number)) return;
    self.stopping.insert(number);
    if (self.state == Implementation::State::Joined)
        self.link.send(wire::EndView{.number = number, .deliver = true});
}

void Session::close_view(std::uint64_t number) {
    Implementation& self = *implementation_;
    self.forget_view(number);
    if (self.state == Implementation::State::Joined) self.link.send(wire::EndView{.number = number});
}

std::optional<Frame> Session::next_frame(TimePoint deadline, std::stop_token stop) {
    Implementation& self = *implementation_;
    pump();
    while (self.frames.empty()) {
        self.throw_refusals();
        if (stop.stop_requested() || !self.receive_next(deadline, stop)) return std::nullopt;
    }
    Frame frame = std::move(self.frames.extract(self.frames.begin()).mapped());
    self.link.send(wire::FrameTaken{frame.view, frame.number});
    return frame;
}

std::optional<Frame> Session::take_frame(std::uint64_t number) {
    Implementation& self = *implementation_;
    auto frame = self.frames.extract(number);
    if (frame.empty()) return std::nullopt;
    self.link.send(wire::FrameTaken{number, frame.mapped().number});
    return std::move(frame.mapped());
}

std::optional<session::ViewProgress> Session::take_progress(std::uint64_t number) {
    auto news = implementation_->progress.extract(number);
    return news.empty() ? std::nullopt : std::optional(news.mapped());
}

std::optional<session::ViewSummary> Session::take_summary(std::uint64_t number) {
    auto end = implementation_->ended_views.extract(number);
    return end.empty() ? std::nullopt : std::optional(std::move(end.mapped().summary));
}

ViewResult Session::wait_for_end(std::uint64_t number,
                                 const std::function<void(const session::ViewProgress&)>& on_progress,
                                 std::stop_token stop, AfterEnd after) {
    Implementation& self = *implementation_;
    TimePoint last_sign = self.clock.now();
    while (true) {
        if (stop.stop_requested() && !self.stopping.contains(number)) stop_view(number);
        const auto done = self.ended_views.find(number);
        const auto frame = self.frames.find(number);
        if (done != self.ended_views.end() && frame != self.frames.end() &&
            frame->second.number == done->second.frame) {
            ViewResult result{std::move(done->second.summary), std::move(frame->second)};
            if (after == AfterEnd::Close) {
                close_view(number);
            } else {
                self.link.send(wire::FrameTaken{number, result.frame.number});
                self.forget_view(number);
            }
            return result;
        }
        // The last frame may arrive before the ViewDone message.
        const bool is_older =
            frame != self.frames.end() && (!frame->second.complete || done != self.ended_views.end());
        if (is_older) {
            self.link.send(wire::FrameTaken{number, frame->second.number});
            self.frames.erase(frame);
        }
        const bool has_come =
            self.receive_next(self.clock.now() + Slice, stop.stop_requested() ? std::stop_token() : stop);
        self.throw_refusals();
        if (const auto news = take_progress(number); news && on_progress) on_progress(*news);
        if (has_come || self.link.is_away()) last_sign = self.clock.now();
        if (self.clock.now() - last_sign < self.settings.lost_limit) continue;
        throw Error(ErrorCode::Unavailable, self.ended_views.contains(number)
                                                ? "the picture did not arrive in full: start again"
                                                : "the master stopped reporting on the frame: start again");
    }
}

std::vector<session::JobStatus> Session::jobs() {
    return implementation_->ask<wire::Jobs>(wire::ReadJobs{}).jobs;
}

ViewResult Session::fetch_job(const session::JobName& job) {
    constexpr std::uint64_t JobNumber = std::uint64_t{1} << 33;  // above the numbers of views
    Implementation& self = *implementation_;
    self.fetched = wire::FetchJob{.number = JobNumber, .job = job};
    try {
        self.send_and_confirm(*self.fetched);
        ViewResult result = wait_for_end(JobNumber, {}, {});
        self.fetched.reset();
        return result;
    } catch (const Error&) {
        self.fetched.reset();
        throw;
    }
}

void Session::cancel_job(const session::JobName& job) {
    implementation_->send_and_confirm(wire::CancelJob{.job = job});
}

void Session::release_node(const std::string& name) {
    implementation_->send_and_confirm(
        wire::ManageNode{.name = name, .order = wire::ManageNode::Order::Release});
}

void Session::drain_node(const std::string& name) {
    implementation_->send_and_confirm(
        wire::ManageNode{.name = name, .order = wire::ManageNode::Order::Drain});
}

std::string Session::set_filter(const std::string& view, const std::string& filter) {
    return implementation_->send_and_confirm(wire::SetViewFilter{.view = view, .filter = filter});
}

std::vector<std::string> Session::take_notices() {
    return std::exchange(implementation_->notices, {});
}

session::PickResult Session::pick(std::uint64_t number, std::uint32_t x, std::uint32_t y) {
    auto picked = implementation_->ask<wire::Picked>(wire::Pick{.number = number, .x = x, .y = y});
    if (!picked.problem.empty()) throw Error(ErrorCode::Refused, picked.problem);
    return picked.result;
}

}  // namespace tessera::client
