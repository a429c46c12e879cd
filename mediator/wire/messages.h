#pragma once

#include "mediator/wire/bulk_messages.h"
#include "mediator/wire/display_messages.h"
#include "mediator/wire/job_messages.h"
#include "mediator/wire/message_table.h"
#include "mediator/wire/peer_messages.h"
#include "mediator/wire/session_messages.h"
#include "mediator/wire/view_messages.h"

// All messages as plain values; `envelope.h` encodes and decodes them. A decoded message is complete and checked, else
// decoding gives an Error.
namespace tessera::wire {

namespace table {
using enum Senders;

// Numbers are those of the oneof in proto/control.proto, where retired ones are reserved.
using Control = MessageTable<
    MessageRow<1, "hello", Hello, Everyone>, MessageRow<2, "welcome", Welcome, Master>,
    MessageRow<3, "refusal", Refusal, Master>, MessageRow<4, "unknown", Unknown, Master>,
    MessageRow<5, "heartbeat", Heartbeat, Everyone>, MessageRow<6, "changes", Changes, Master>,
    MessageRow<7, "changes_by_blob", ChangesByBlob, Master>,
    MessageRow<8, "version_report", VersionReport, Nodes>, MessageRow<9, "resync", Resync, Nodes>,
    MessageRow<10, "open_view", OpenView, Master>, MessageRow<11, "close_view", CloseView, Master>,
    MessageRow<12, "work", Work, Master>, MessageRow<13, "cancel_units", CancelUnits, Master>,
    MessageRow<14, "unit_released", UnitReleased, Nodes>, MessageRow<15, "leave", Leave, Master>,
    MessageRow<16, "goodbye", Goodbye, Everyone>, MessageRow<17, "notice", Notice, Nodes>,
    MessageRow<21, "submit_edit", SubmitEdit, Editors>,
    MessageRow<22, "submit_edit_by_blob", SubmitEditByBlob, Editors>,
    MessageRow<23, "edit_reply", EditReply, Master>, MessageRow<28, "status_request", StatusRequest, Clients>,
    MessageRow<29, "status_reply", StatusReply, Master>, MessageRow<32, "scene_refused", SceneRefused, Nodes>,
    MessageRow<33, "join_scene", JoinScene, Clients>, MessageRow<34, "scene_joined", SceneJoined, Master>,
    MessageRow<35, "request_done", RequestDone, Master>, MessageRow<36, "close_scene", CloseScene, Editors>,
    MessageRow<37, "read_scene", ReadScene, Clients>, MessageRow<38, "scene_content", SceneContent, Master>,
    MessageRow<39, "lock_objects", LockObjects, Editors>,
    MessageRow<40, "set_presence", SetPresence, Clients>,
    MessageRow<41, "read_members", ReadMembers, Clients>, MessageRow<42, "members", Members, Master>,
    MessageRow<43, "read_history", ReadHistory, Editors>, MessageRow<44, "history", History, Master>,
    MessageRow<45, "read_writers", ReadWriters, Editors>, MessageRow<46, "writers", Writers, Master>,
    MessageRow<49, "frame_taken", FrameTaken, Clients>, MessageRow<50, "pick", Pick, Clients>,
    MessageRow<51, "picked", Picked, Master>, MessageRow<52, "read_trace", ReadTrace, Editors>,
    MessageRow<53, "trace", Trace, Master>, MessageRow<54, "open_display", OpenDisplay, Editors>,
    MessageRow<55, "close_display", CloseDisplay, Editors>,
    MessageRow<56, "adjust_display", AdjustDisplay, Editors>, MessageRow<57, "move_head", MoveHead, Editors>,
    MessageRow<58, "join_output", JoinOutput, Clients>, MessageRow<59, "output_opened", OutputOpened, Master>,
    MessageRow<60, "output_ready", OutputReady, Clients>,
    MessageRow<61, "present_frame", PresentFrame, Master>,
    MessageRow<62, "request_view", RequestView, Clients>, MessageRow<63, "end_view", EndView, Clients>,
    MessageRow<64, "view_progress", ViewProgress, Master>, MessageRow<65, "view_done", ViewDone, Master>,
    MessageRow<66, "set_view_filter", SetViewFilter, Editors>, MessageRow<67, "read_jobs", ReadJobs, Clients>,
    MessageRow<68, "jobs", Jobs, Master>, MessageRow<69, "fetch_job", FetchJob, Clients>,
    MessageRow<70, "cancel_job", CancelJob, Editors>, MessageRow<71, "film_taken", FilmTaken, Master>,
    MessageRow<72, "manage_node", ManageNode, Operators>>;

// The number is the second word of a bulk message. Add retired ones to the check below.
using Bulk = MessageTable<
    MessageRow<0, "bulk_hello", BulkHello, Everyone>, MessageRow<1, "blob_request", BlobRequest, Everyone>,
    MessageRow<2, "blob_chunk", BlobChunk, Editors>, MessageRow<3, "blob_absent", BlobAbsent, Editors>,
    MessageRow<4, "film_part", FilmPart, Nodes>, MessageRow<5, "frame_tile", FrameTile, Master>,
    MessageRow<6, "picture_chunk", PictureChunk, Master>,
    MessageRow<8, "output_picture", OutputPicture, Master>,
    MessageRow<9, "frame_header", FrameHeader, Master>, MessageRow<10, "film_block", FilmBlock, Master>>;

static_assert(Control::is_valid({18, 19, 20, 24, 25, 26, 27, 30, 31, 47, 48}));
static_assert(Bulk::is_valid({7}));
}  // namespace table

using ControlMessage = table::Control::Message;
using BulkMessage = table::Bulk::Message;

// Templates, so that these long lists cost no compile time where they are not used.
template <std::same_as<ControlMessage> M>
constexpr auto alternatives(const M*) {
    return table::Control::alternatives();
}
template <std::same_as<BulkMessage> M>
constexpr auto alternatives(const M*) {
    return table::Bulk::alternatives();
}

}  // namespace tessera::wire
