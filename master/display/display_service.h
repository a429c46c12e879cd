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
#include "master/scene/published_scene.h"
#include "mediator/display/display.h"
#include "mediator/view/placed_cameras.h"

namespace tessera::master {

// The display of the live scene: its output clients, the view of each eye, and the frames in flight to all outputs. The
// views progress in lockstep (lockstep_group.h); one frame is reconstructed while another is sent and presented
// (frame_lock.h). Driven by messages from the render master.
class DisplayService {
  public:
    DisplayService(const PublishedScene& scene, SessionTable& sessions, Views& renderer, Outbox& outbox,
                   EventSink events);

    // `content`: the blobs that the description refers to; kept as long as the display. Returns "" or the problem.
    std::string open(const scene::BlobPtr& description, std::vector<scene::BlobPtr> content, TimePoint now);
    void close();
    bool is_open() const { return open_.has_value(); }
    bool has(const Hash256& blob) const;  // the description, or a blob that it refers to

    // Returns "" or the problem.
    std::string adjust(const session::DisplayAdjustment& request);
    void move_head(const display::Head& head);
    std::string join(const SessionRecord& session, const wire::JoinOutput& request, TimePoint now);
    void ready(SessionId session, const wire::OutputReady& ready, TimePoint now);
    void left(SessionId session, TimePoint now);
    // A result of reconstruct_output().
    void add_output(OutputResult&& output, TimePoint now);
    // A version is published. True: the camera that carries the display has moved or reappeared.
    bool scene_changed(const scene::ChangeList& changes);
    // Empty without a display or without its camera.
    std::optional<glm::dvec3> head_in_world() const;

    void tick(TimePoint now);  // after every message
    TimePoint next_event() const;
    session::DisplayStatus status(TimePoint now) const;

  private:
    // A process that shows an output. Pictures and control messages use different links, so it gets pictures only after it
    // has answered all messages about the display.
    struct OutputClient {
        SessionId session;
        std::string host;
        std::uint64_t request = 0;   // its latest
        std::size_t unanswered = 0;  // OutputOpened without its OutputReady, of frame 0
    };
    // A frame whose pictures are being reconstructed, or wait for the lock.
    struct Frame {
        std::uint64_t number = 0;
        Version version;
        std::size_t missing = 0;            // outputs whose pictures are not reconstructed yet
        std::vector<OutputResult> outputs;  // by index
        bool failed = false;
    };
    // One eye of an output, as its views were requested; they are consecutive in the group.
    struct PlannedEye {
        view::CameraPose in_display;
        std::size_t layers = 0;  // a view each
    };
    struct Open {
        display::Display display;  // adjusted, with the head as it is now
        scene::BlobRef description;
        std::vector<scene::BlobPtr> content;
        bool pattern = false;
        view::FollowedCamera camera;  // carries the display, in the published version
        FrameLock lock;
        std::vector<std::optional<OutputClient>> output_clients;  // by output
        std::vector<double> stereo_differences;                   // by output; 0 = unknown
        std::vector<std::uint64_t> samples;                       // by output, in the latest frame
        std::vector<std::vector<PlannedEye>> plan;                // by output: the views of the group
        std::deque<Frame> in_progress;                            // oldest first
        std::optional<Frame> waiting, latest;                     // latest: for outputs that join later
        Version version;                                          // of the latest frame
    };

    std::vector<GroupView> views();
    bool can_take() const;
    void take(const GroupStage& stage);
    void admit();  // outputs that are able to join
    void send_waiting(TimePoint now);
    void send(std::size_t output);  // the latest frame
    void present(const std::optional<FrameLock::Present>& present, TimePoint now);
    void report_camera();
    std::optional<std::size_t> output_of(SessionId session) const;
    void notify_opened(std::size_t output, std::uint64_t request);
    void forget();
    void dismiss(const OutputClient& output_client, const std::string& reason);  // it will ask again

    const PublishedScene& scene_;
    SessionTable& sessions_;
    Views& renderer_;
    Outbox& outbox_;
    EventSink events_;
    std::optional<Open> open_;
    std::uint64_t next_frame_ = 1;  // over all displays
};

}  // namespace tessera::master
