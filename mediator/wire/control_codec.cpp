#include <utility>

#include "mediator/wire/control_mapping.h"
#include "mediator/wire/entry_codec.h"
#include "mediator/wire/envelope.h"

namespace tessera::wire {

namespace {

constexpr std::size_t ControlBytes = 64 * 1024;

// One line a message: where it lives in the envelope.
proto::Hello& part(proto::Control& c, const Hello&) {
    return *c.mutable_hello();
}
proto::Welcome& part(proto::Control& c, const Welcome&) {
    return *c.mutable_welcome();
}
proto::Refusal& part(proto::Control& c, const Refusal&) {
    return *c.mutable_refusal();
}
proto::Unknown& part(proto::Control& c, const Unknown&) {
    return *c.mutable_unknown();
}
proto::Heartbeat& part(proto::Control& c, const Heartbeat&) {
    return *c.mutable_heartbeat();
}
proto::Changes& part(proto::Control& c, const Changes&) {
    return *c.mutable_changes();
}
proto::ChangesByBlob& part(proto::Control& c, const ChangesByBlob&) {
    return *c.mutable_changes_by_blob();
}
proto::VersionReport& part(proto::Control& c, const VersionReport&) {
    return *c.mutable_version_report();
}
proto::Resync& part(proto::Control& c, const Resync&) {
    return *c.mutable_resync();
}
proto::SceneRefused& part(proto::Control& c, const SceneRefused&) {
    return *c.mutable_scene_refused();
}
proto::OpenView& part(proto::Control& c, const OpenView&) {
    return *c.mutable_open_view();
}
proto::CloseView& part(proto::Control& c, const CloseView&) {
    return *c.mutable_close_view();
}
proto::Work& part(proto::Control& c, const Work&) {
    return *c.mutable_work();
}
proto::CancelUnits& part(proto::Control& c, const CancelUnits&) {
    return *c.mutable_cancel_units();
}
proto::UnitReleased& part(proto::Control& c, const UnitReleased&) {
    return *c.mutable_unit_released();
}
proto::Leave& part(proto::Control& c, const Leave&) {
    return *c.mutable_leave();
}
proto::Goodbye& part(proto::Control& c, const Goodbye&) {
    return *c.mutable_goodbye();
}
proto::Notice& part(proto::Control& c, const Notice&) {
    return *c.mutable_notice();
}
proto::OpenScene& part(proto::Control& c, const OpenScene&) {
    return *c.mutable_open_scene();
}
proto::QueuePlace& part(proto::Control& c, const QueuePlace&) {
    return *c.mutable_queue_place();
}
proto::SceneOpened& part(proto::Control& c, const SceneOpened&) {
    return *c.mutable_scene_opened();
}
proto::SubmitEdit& part(proto::Control& c, const SubmitEdit&) {
    return *c.mutable_submit_edit();
}
proto::SubmitEditByBlob& part(proto::Control& c, const SubmitEditByBlob&) {
    return *c.mutable_submit_edit_by_blob();
}
proto::EditReply& part(proto::Control& c, const EditReply&) {
    return *c.mutable_edit_reply();
}
proto::StartJob& part(proto::Control& c, const StartJob&) {
    return *c.mutable_start_job();
}
proto::StopJob& part(proto::Control& c, const StopJob&) {
    return *c.mutable_stop_job();
}
proto::JobProgress& part(proto::Control& c, const JobProgress&) {
    return *c.mutable_job_progress();
}
proto::JobDone& part(proto::Control& c, const JobDone&) {
    return *c.mutable_job_done();
}
proto::StatusRequest& part(proto::Control& c, const StatusRequest&) {
    return *c.mutable_status_request();
}
proto::StatusReply& part(proto::Control& c, const StatusReply&) {
    return *c.mutable_status_reply();
}
proto::SetFilter& part(proto::Control& c, const SetFilter&) {
    return *c.mutable_set_filter();
}
proto::FilterSet& part(proto::Control& c, const FilterSet&) {
    return *c.mutable_filter_set();
}
proto::JoinScene& part(proto::Control& c, const JoinScene&) {
    return *c.mutable_join_scene();
}
proto::SceneJoined& part(proto::Control& c, const SceneJoined&) {
    return *c.mutable_scene_joined();
}
proto::RequestDone& part(proto::Control& c, const RequestDone&) {
    return *c.mutable_request_done();
}
proto::CloseScene& part(proto::Control& c, const CloseScene&) {
    return *c.mutable_close_scene();
}
proto::ReadScene& part(proto::Control& c, const ReadScene&) {
    return *c.mutable_read_scene();
}
proto::SceneContent& part(proto::Control& c, const SceneContent&) {
    return *c.mutable_scene_content();
}
proto::LockObjects& part(proto::Control& c, const LockObjects&) {
    return *c.mutable_lock_objects();
}
proto::SetPresence& part(proto::Control& c, const SetPresence&) {
    return *c.mutable_set_presence();
}
proto::ReadPeople& part(proto::Control& c, const ReadPeople&) {
    return *c.mutable_read_people();
}
proto::People& part(proto::Control& c, const People&) {
    return *c.mutable_people();
}
proto::ReadHistory& part(proto::Control& c, const ReadHistory&) {
    return *c.mutable_read_history();
}
proto::History& part(proto::Control& c, const History&) {
    return *c.mutable_history();
}
proto::ReadWriters& part(proto::Control& c, const ReadWriters&) {
    return *c.mutable_read_writers();
}
proto::Writers& part(proto::Control& c, const Writers&) {
    return *c.mutable_writers();
}
proto::OpenLiveView& part(proto::Control& c, const OpenLiveView&) {
    return *c.mutable_open_live_view();
}
proto::CloseLiveView& part(proto::Control& c, const CloseLiveView&) {
    return *c.mutable_close_live_view();
}
proto::FrameTaken& part(proto::Control& c, const FrameTaken&) {
    return *c.mutable_frame_taken();
}
proto::Pick& part(proto::Control& c, const Pick&) {
    return *c.mutable_pick();
}
proto::Picked& part(proto::Control& c, const Picked&) {
    return *c.mutable_picked();
}
proto::ReadTrace& part(proto::Control& c, const ReadTrace&) {
    return *c.mutable_read_trace();
}
proto::Trace& part(proto::Control& c, const Trace&) {
    return *c.mutable_trace();
}
proto::OpenDisplay& part(proto::Control& c, const OpenDisplay&) {
    return *c.mutable_open_display();
}
proto::CloseDisplay& part(proto::Control& c, const CloseDisplay&) {
    return *c.mutable_close_display();
}
proto::AdjustDisplay& part(proto::Control& c, const AdjustDisplay&) {
    return *c.mutable_adjust_display();
}
proto::MoveHead& part(proto::Control& c, const MoveHead&) {
    return *c.mutable_move_head();
}
proto::JoinOutput& part(proto::Control& c, const JoinOutput&) {
    return *c.mutable_join_output();
}
proto::OutputOpened& part(proto::Control& c, const OutputOpened&) {
    return *c.mutable_output_opened();
}
proto::OutputReady& part(proto::Control& c, const OutputReady&) {
    return *c.mutable_output_ready();
}
proto::PresentFrame& part(proto::Control& c, const PresentFrame&) {
    return *c.mutable_present_frame();
}

template <class Message>
std::vector<std::byte> serialized(const Message& message) {
    std::vector<std::byte> bytes(message.ByteSizeLong());
    if (!message.SerializeToArray(bytes.data(), static_cast<int>(bytes.size()))) {
        throw Error(ErrorCode::InvalidInput, "a message is longer than 2 GiB: split the edit");
    }
    return bytes;
}

template <class Message>
bool parsed(Message& message, std::span<const std::byte> bytes) {
    return bytes.size() <= static_cast<std::size_t>(std::numeric_limits<int>::max()) &&
           message.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()));
}

// The alternative of the variant with the index of the oneof's case: both are in the same order.
template <std::size_t... I>
ControlMessage alternative(std::size_t index, std::index_sequence<I...>) {
    ControlMessage message;
    ((index == I ? (void)message.emplace<I>() : (void)0), ...);
    return message;
}

}  // namespace

std::vector<std::byte> encode(const ControlMessage& message) {
    proto::Control control;
    std::visit([&](const auto& s) { map(Writer(), s, part(control, s)); }, message);
    return serialized(control);
}

bool fits_control(const ControlMessage& message) {
    return encode(message).size() <= ControlBytes;
}

Expected<ControlMessage> decode_control(std::span<const std::byte> bytes) {
    if (bytes.size() > ControlBytes) {
        return failure(ErrorCode::InvalidInput, "malformed message: longer than 64 KiB");
    }
    proto::Control control;
    if (!parsed(control, bytes))
        return failure(ErrorCode::InvalidInput, "malformed message: not this protocol");
    if (control.message_case() == proto::Control::MESSAGE_NOT_SET) {
        return failure(ErrorCode::InvalidInput, "malformed message: of an unknown kind");
    }
    try {
        ControlMessage message = alternative(static_cast<std::size_t>(control.message_case()) - 1,
                                             std::make_index_sequence<std::variant_size_v<ControlMessage>>{});
        std::visit([&](auto& s) { map(Reader(), s, part(control, s)); }, message);
        return message;
    } catch (const Error& error) {
        return tl::unexpected(error);
    }
}

std::vector<std::byte> encode(const scene::ChangeList& changes) {
    return to_bytes(changes);
}

Expected<scene::ChangeList> decode_change_list(std::span<const std::byte> bytes) {
    return from_bytes<scene::ChangeList>(bytes);
}

std::vector<std::byte> encode(const scene::Edit& edit) {
    return to_bytes(edit);
}

Expected<scene::Edit> decode_edit(std::span<const std::byte> bytes) {
    return from_bytes<scene::Edit>(bytes);
}

}  // namespace tessera::wire
