#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "master/display/frame_lock.h"
#include "master/peers/session_table.h"
#include "master/render/views.h"
#include "master/scene/scene_authority.h"
#include "mediator/display/display.h"
#include "mediator/view/placed_cameras.h"

namespace tessera::master {

// The display in front of the live scene: who shows which output, what each eye sees, and the frames on their
// way to all outputs. The views go in lockstep (lockstep_group.h); one frame is made while another is sent and
// presented (frame_lock.h). Told of messages by the render master.
class DisplayService {
  public:
    DisplayService(SceneAuthority& authority, SessionTable& sessions, Views& renderer, Outbox& outbox,
                   EventSink events);

    // `content`: the description's blob and those that it refers to; kept as long as the display. "" or what
    // is wrong with it.
    std::string open(const scene::BlobPtr& description, std::vector<scene::BlobPtr> content, TimePoint now);
    void close();
    bool is_open() const { return open_.has_value(); }

    // "" or what is wrong.
    std::string adjust(const session::DisplayAdjustment& request);
    void move_head(const display::Head& head);
    std::string join(const SessionRecord& session, const wire::JoinOutput& request, TimePoint now);
    void ready(SessionId session, const wire::OutputReady& ready, TimePoint now);
    void left(SessionId session, TimePoint now);
    // The pictures that make_output() was ordered to make.
    void made(MadeOutput&& made, TimePoint now);
    // A version is published. True: the camera that carries the display is somewhere else, or there again.
    bool scene_changed(const scene::ChangeList& changes);
    // Nothing without a display, or a camera that carries it.
    std::optional<glm::dvec3> head_in_world() const;

    void tick(TimePoint now);  // after every message
    TimePoint next_event() const;
    session::DisplayStatus status(TimePoint now) const;

  private:
    // A process that shows an output. Pictures and orders go different ways, so it gets pictures only when it
    // has answered everything that it was told of the display.
    struct Shower {
        SessionId session;
        std::string host;
        std::uint64_t request = 0;   // its latest
        std::size_t unanswered = 0;  // OutputOpened without its OutputReady, of frame 0
    };
    // A frame whose pictures are being made, or wait for the lock.
    struct Frame {
        std::uint64_t number = 0;
        Version version;
        std::size_t missing = 0;          // outputs whose pictures are not made yet
        std::vector<MadeOutput> outputs;  // by index
        bool failed = false;
    };
    // One eye of an output, as its views were asked for; they follow each other in the group.
    struct PlannedEye {
        view::CameraPose in_display;
        std::size_t layers = 0;  // a view each
    };
    struct Open {
        display::Display display;  // adjusted, with the head as it is now
        scene::BlobRef description;
        std::vector<scene::BlobPtr> content;
        bool pattern = false;
        view::FollowedCamera camera;  // carries the display, in the version that is published
        FrameLock lock;
        std::vector<std::optional<Shower>> showers;  // by output
        std::vector<double> stereo_differences;      // by output; 0 = unknown
        std::vector<std::uint64_t> samples;          // by output, in the latest frame
        std::vector<std::vector<PlannedEye>> plan;   // by output: what the group renders
        std::deque<Frame> making;                    // oldest first
        std::optional<Frame> waiting, latest;        // latest: for outputs that come later
        Version version;                             // of the latest frame
    };

    std::vector<GroupView> views();
    bool can_take() const;
    void take(const GroupStage& stage);
    void admit();  // who is able to take part and does not yet
    void send_waiting(TimePoint now);
    void send(std::size_t output);  // the latest frame
    void present(const std::optional<FrameLock::Present>& present, TimePoint now);
    void tell_of_camera();
    std::optional<std::size_t> output_of(SessionId session) const;
    void tell(std::size_t output, std::uint64_t request);
    void forget();
    void dismiss(const Shower& shower, const std::string& reason);  // it asks again

    SceneAuthority& authority_;
    SessionTable& sessions_;
    Views& renderer_;
    Outbox& outbox_;
    EventSink events_;
    std::optional<Open> open_;
    std::uint64_t next_frame_ = 1;  // over all displays
};

}  // namespace tessera::master
