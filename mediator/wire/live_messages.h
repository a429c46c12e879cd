#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "mediator/base/clock.h"
#include "mediator/scene/change_list.h"
#include "mediator/view/view.h"

// What members of a live scene and the master say to each other. `request` is the asking client's number and
// comes back with the answer.
namespace tessera::wire {

// What the master makes of the film: nothing, the filtered picture as float32 planes one after another, a
// file, or (of outputs of displays alone) red, green and blue of each pixel: 8-bit sRGB, or linear half
// floats.
enum class PictureEncoding : std::uint8_t { None, Planes, Png, Jpeg, Exr, Bytes, Half };

// Joins the live scene, or starts one when the stage is free. Answered by QueuePlace while a batch scene has
// the stage, then SceneJoined; or Refusal.
struct JoinScene {
    std::string title;  // of a scene that is started; one that is there keeps its own
    std::string name;   // of the member, for people; made unique by the master
    std::uint64_t key =
        0;  // chosen by the client, secret: the same editor again after a restart of the master
    bool no_wait = false;
};
struct SceneJoined {
    Version version;                           // published
    std::uint64_t first_id = 0, id_count = 0;  // lent to this editor for new objects
    std::uint64_t last_sequence = 0;  // of its edits that were answered: later ones are to be sent again
    std::string title, name;
};
// Answers what has no answer of its own.
struct RequestDone {
    std::uint64_t request = 0;
    bool accepted = false;
    std::string text;  // why not
};
// The scene and its views go; whoever waits has the stage.
struct CloseScene {
    std::uint64_t request = 0;
};

// What the scene is now: a change list from `known`, or a snapshot where the master no longer knows that.
struct ReadScene {
    std::uint64_t request = 0;
    Version known;
};
struct SceneContent {
    std::uint64_t request = 0;
    scene::ChangeList list;
    scene::BlobRef blob;  // not empty: the list is in this blob
};

// While an object is locked, edits of others that touch it are refused. Locks go with their session.
struct LockObjects {
    std::uint64_t request = 0;
    std::vector<ObjectId> objects;
    bool release = false;
};
// What this member does, for the others; forgotten after `time_to_live`. No answer.
struct SetPresence {
    std::string text;
    std::vector<ObjectId> selection;
    Duration time_to_live{};
};
struct ReadPeople {
    std::uint64_t request = 0;
};
struct Person {
    SessionId session;
    std::string name, user;  // user: of the key
    std::string text;        // presence
    std::vector<ObjectId> selection;
    bool editor = false;
    double clock_offset_seconds = 0, clock_bound_seconds = 0;  // its clock less the master's, +- bound
};
struct ObjectLock {
    ObjectId object;
    std::string name;  // of the member that holds it
};
struct LiveViewSummary {
    std::string name, owner;
    std::uint32_t width = 0, height = 0;
    std::uint64_t samples = 0, spp = 0;  // per pixel, the least so far and in the end
    std::uint64_t watchers = 0;
};
struct People {
    std::uint64_t request = 0;
    std::string title;
    std::vector<Person> people;
    std::vector<ObjectLock> locks;
    std::vector<LiveViewSummary> views;
};

// The latest transactions, youngest first.
struct ReadHistory {
    std::uint64_t request = 0;
    std::uint32_t count = 0;
};
struct TransactionSummary {
    std::uint64_t number = 0;
    std::string name, user;
    std::int64_t time = 0;    // ns since 1970
    std::uint32_t edits = 0;  // in one gesture
    std::string text;         // what it did, for people
    std::uint64_t undoes = 0, undone_by = 0;
};
struct History {
    std::uint64_t request = 0;
    std::vector<TransactionSummary> transactions;
};
// Who wrote the fields of an object last; fields without a writer are as they came with the object.
struct ReadWriters {
    std::uint64_t request = 0;
    ObjectId object;
};
struct FieldWriter {
    std::uint32_t field = 0;
    std::uint64_t transaction = 0;
    std::string name, user;
    std::int64_t time = 0;  // ns since 1970
};
struct Writers {
    std::uint64_t request = 0;
    std::vector<FieldWriter> fields;
};

// A view of this client under a number of its own. Again with the same number: another camera, size or
// quality, the latest wins. `request` 0: only a refusal is answered.
struct OpenLiveView {
    std::uint64_t request = 0;
    std::uint64_t number = 0;
    std::string name;  // for others who want to watch it; "" = the master's choice
    view::View view;   // id and revision are the master's to choose
    std::uint64_t spp = 0;
    PictureEncoding picture = PictureEncoding::None;
    bool film = false;   // statistics, too
    bool share = false;  // watch the view that has this name, whatever its camera: `view` means nothing
};
struct CloseLiveView {
    std::uint64_t number = 0;
};
struct FrameTaken {
    std::uint64_t number = 0, frame = 0;
};
// What is seen in the middle of a pixel.
struct Pick {
    std::uint64_t request = 0, number = 0;
    std::uint32_t x = 0, y = 0;
};
struct Picked {
    std::uint64_t request = 0;
    Version version;
    bool hit = false;
    ObjectId object;           // the Geometry
    glm::dvec3 position{0.0};  // world
    glm::vec3 normal{0.0f};    // shading normal, world
    double distance = 0;       // from the eye
    std::string problem;       // not empty: there is no answer, and why
};

// How long the latest edits took. Times in ns of the master's clock, 0 = not known (yet).
struct ReadTrace {
    std::uint64_t request = 0;
    std::uint32_t count = 0;
};
struct NodeTrace {
    std::string name;
    std::int64_t received = 0, built = 0;
    std::int64_t bound = 0;  // of its clock's offset
};
struct EditTrace {
    std::uint64_t transaction = 0;
    std::string name;  // who
    std::uint64_t edit_bytes = 0;
    std::int64_t submitted = 0, bound = 0;  // bound: of the client's clock's offset
    std::int64_t received = 0, published = 0;
    std::vector<NodeTrace> nodes;
    std::int64_t merged = 0;  // the first picture of its version
    Version version;
};
struct Trace {
    std::uint64_t request = 0;
    std::vector<EditTrace> edits;
};

struct StageTimes {
    std::string name;
    std::uint64_t count = 0;
    double p50_seconds = 0, p99_seconds = 0;
};
struct LiveStatus {
    std::string title;  // "" = no live scene
    std::uint32_t members = 0, views = 0;
    std::uint64_t edits = 0, transactions = 0, edit_bytes = 0;
    std::uint64_t versions = 0, change_bytes = 0;  // published; sent to all nodes together
    std::uint64_t journal_bytes = 0, checkpoints = 0;
    std::vector<StageTimes> stages;
};

}  // namespace tessera::wire
