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
constexpr auto enumerators(PictureEncoding) {
    return std::to_array<std::string_view>({"none", "planes", "png", "jpeg", "exr", "bytes", "half"});
}

// Joins the live scene, or starts one when the stage is free. Answered by QueuePlace while a batch scene has
// the stage, then SceneJoined; or Refusal.
struct JoinScene {
    std::string title;  // of a scene that is started; one that is there keeps its own
    std::string name;   // of the member, for people; made unique by the master
    std::uint64_t key =
        0;  // chosen by the client, secret: the same editor again after a restart of the master
    bool no_wait = false;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "title", &JoinScene::title), row(2, "name", &JoinScene::name),
                          row(3, "key", &JoinScene::key, FullWidth{}),
                          row(4, "no_wait", &JoinScene::no_wait));
    }
};
struct SceneJoined {
    Version version;                           // published
    std::uint64_t first_id = 0, id_count = 0;  // lent to this editor for new objects
    std::uint64_t last_sequence = 0;  // of its edits that were answered: later ones are to be sent again
    std::string title, name;
    static constexpr auto describe(auto row) {
        return std::tuple(
            row(1, "version", &SceneJoined::version), row(2, "first_id", &SceneJoined::first_id),
            row(3, "id_count", &SceneJoined::id_count), row(4, "last_sequence", &SceneJoined::last_sequence),
            row(5, "title", &SceneJoined::title), row(6, "name", &SceneJoined::name));
    }
};
// Answers what has no answer of its own.
struct RequestDone {
    std::uint64_t request = 0;
    bool accepted = false;
    std::string text;  // why not
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "request", &RequestDone::request),
                          row(2, "accepted", &RequestDone::accepted), row(3, "text", &RequestDone::text));
    }
};
// The scene and its views go; whoever waits has the stage.
struct CloseScene {
    std::uint64_t request = 0;
    static constexpr auto describe(auto row) { return std::tuple(row(1, "request", &CloseScene::request)); }
};

// What the scene is now: a change list from `known`, or a snapshot where the master no longer knows that.
struct ReadScene {
    std::uint64_t request = 0;
    Version known;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "request", &ReadScene::request), row(2, "known", &ReadScene::known));
    }
};
struct SceneContent {
    std::uint64_t request = 0;
    scene::ChangeList list;
    scene::BlobRef blob;  // not empty: the list is in this blob
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "request", &SceneContent::request), row(2, "list", &SceneContent::list),
                          row(3, "blob", &SceneContent::blob));
    }
};

// While an object is locked, edits of others that touch it are refused. Locks go with their session.
struct LockObjects {
    std::uint64_t request = 0;
    std::vector<ObjectId> objects;
    bool release = false;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "request", &LockObjects::request), row(2, "objects", &LockObjects::objects),
                          row(3, "release", &LockObjects::release));
    }
};
// What this member does, for the others; forgotten after `time_to_live`. No answer.
struct SetPresence {
    std::string text;
    std::vector<ObjectId> selection;
    Duration time_to_live{};
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "text", &SetPresence::text), row(2, "selection", &SetPresence::selection),
                          row(3, "time_to_live", &SetPresence::time_to_live));
    }
};
struct ReadPeople {
    std::uint64_t request = 0;
    static constexpr auto describe(auto row) { return std::tuple(row(1, "request", &ReadPeople::request)); }
};
struct Person {
    SessionId session;
    std::string name, user;  // user: of the key
    std::string text;        // presence
    std::vector<ObjectId> selection;
    bool editor = false;
    double clock_offset_seconds = 0, clock_bound_seconds = 0;  // its clock less the master's, +- bound
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "session", &Person::session), row(2, "name", &Person::name),
                          row(3, "user", &Person::user), row(4, "text", &Person::text),
                          row(5, "selection", &Person::selection), row(6, "editor", &Person::editor),
                          row(7, "clock_offset_seconds", &Person::clock_offset_seconds),
                          row(8, "clock_bound_seconds", &Person::clock_bound_seconds));
    }
};
struct ObjectLock {
    ObjectId object;
    std::string name;  // of the member that holds it
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "object", &ObjectLock::object), row(2, "name", &ObjectLock::name));
    }
};
struct LiveViewSummary {
    std::string name, owner;
    std::uint32_t width = 0, height = 0;
    std::uint64_t samples = 0, spp = 0;  // per pixel, the least so far and in the end
    std::uint64_t watchers = 0;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "name", &LiveViewSummary::name), row(2, "owner", &LiveViewSummary::owner),
                          row(3, "width", &LiveViewSummary::width),
                          row(4, "height", &LiveViewSummary::height),
                          row(5, "samples", &LiveViewSummary::samples), row(6, "spp", &LiveViewSummary::spp),
                          row(7, "watchers", &LiveViewSummary::watchers));
    }
};
struct People {
    std::uint64_t request = 0;
    std::string title;
    std::vector<Person> people;
    std::vector<ObjectLock> locks;
    std::vector<LiveViewSummary> views;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "request", &People::request), row(2, "title", &People::title),
                          row(3, "people", &People::people), row(4, "locks", &People::locks),
                          row(5, "views", &People::views));
    }
};

// The latest transactions, youngest first.
struct ReadHistory {
    std::uint64_t request = 0;
    std::uint32_t count = 0;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "request", &ReadHistory::request), row(2, "count", &ReadHistory::count));
    }
};
struct TransactionSummary {
    std::uint64_t number = 0;
    std::string name, user;
    std::int64_t time = 0;    // ns since 1970
    std::uint32_t edits = 0;  // in one gesture
    std::string text;         // what it did, for people
    std::uint64_t undoes = 0, undone_by = 0;
    static constexpr auto describe(auto row) {
        using Self = TransactionSummary;
        return std::tuple(row(1, "number", &Self::number), row(2, "name", &Self::name),
                          row(3, "user", &Self::user), row(4, "time", &Self::time),
                          row(5, "edits", &Self::edits), row(6, "text", &Self::text),
                          row(7, "undoes", &Self::undoes), row(8, "undone_by", &Self::undone_by));
    }
};
struct History {
    std::uint64_t request = 0;
    std::vector<TransactionSummary> transactions;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "request", &History::request),
                          row(2, "transactions", &History::transactions));
    }
};
// Who wrote the fields of an object last; fields without a writer are as they came with the object.
struct ReadWriters {
    std::uint64_t request = 0;
    ObjectId object;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "request", &ReadWriters::request), row(2, "object", &ReadWriters::object));
    }
};
struct FieldWriter {
    std::uint32_t field = 0;
    std::uint64_t transaction = 0;
    std::string name, user;
    std::int64_t time = 0;  // ns since 1970
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "field", &FieldWriter::field),
                          row(2, "transaction", &FieldWriter::transaction),
                          row(3, "name", &FieldWriter::name), row(4, "user", &FieldWriter::user),
                          row(5, "time", &FieldWriter::time));
    }
};
struct Writers {
    std::uint64_t request = 0;
    std::vector<FieldWriter> fields;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "request", &Writers::request), row(2, "fields", &Writers::fields));
    }
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
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "request", &OpenLiveView::request), row(2, "number", &OpenLiveView::number),
                          row(3, "name", &OpenLiveView::name), row(4, "view", &OpenLiveView::view),
                          row(5, "spp", &OpenLiveView::spp),
                          row(6, "picture", &OpenLiveView::picture, UpTo{PictureEncoding::Exr}),
                          row(7, "film", &OpenLiveView::film), row(8, "share", &OpenLiveView::share));
    }
};
struct CloseLiveView {
    std::uint64_t number = 0;
    static constexpr auto describe(auto row) { return std::tuple(row(1, "number", &CloseLiveView::number)); }
};
struct FrameTaken {
    std::uint64_t number = 0, frame = 0;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "number", &FrameTaken::number), row(2, "frame", &FrameTaken::frame));
    }
};
// What is seen in the middle of a pixel.
struct Pick {
    std::uint64_t request = 0, number = 0;
    std::uint32_t x = 0, y = 0;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "request", &Pick::request), row(2, "number", &Pick::number),
                          row(3, "x", &Pick::x), row(4, "y", &Pick::y));
    }
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
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "request", &Picked::request), row(2, "version", &Picked::version),
                          row(3, "hit", &Picked::hit), row(4, "object", &Picked::object),
                          row(5, "position", &Picked::position), row(6, "normal", &Picked::normal),
                          row(7, "distance", &Picked::distance), row(8, "problem", &Picked::problem));
    }
};

// How long the latest edits took. Times in ns of the master's clock, 0 = not known (yet).
struct ReadTrace {
    std::uint64_t request = 0;
    std::uint32_t count = 0;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "request", &ReadTrace::request), row(2, "count", &ReadTrace::count));
    }
};
struct NodeTrace {
    std::string name;
    std::int64_t received = 0, built = 0;
    std::int64_t bound = 0;  // of its clock's offset
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "name", &NodeTrace::name), row(2, "received", &NodeTrace::received),
                          row(3, "built", &NodeTrace::built), row(4, "bound", &NodeTrace::bound));
    }
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
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "transaction", &EditTrace::transaction), row(2, "name", &EditTrace::name),
                          row(3, "edit_bytes", &EditTrace::edit_bytes),
                          row(4, "submitted", &EditTrace::submitted), row(5, "bound", &EditTrace::bound),
                          row(6, "received", &EditTrace::received),
                          row(7, "published", &EditTrace::published), row(8, "nodes", &EditTrace::nodes),
                          row(9, "merged", &EditTrace::merged), row(10, "version", &EditTrace::version));
    }
};
struct Trace {
    std::uint64_t request = 0;
    std::vector<EditTrace> edits;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "request", &Trace::request), row(2, "edits", &Trace::edits));
    }
};

struct StageTimes {
    std::string name;
    std::uint64_t count = 0;
    double p50_seconds = 0, p99_seconds = 0;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "name", &StageTimes::name), row(2, "count", &StageTimes::count),
                          row(3, "p50_seconds", &StageTimes::p50_seconds),
                          row(4, "p99_seconds", &StageTimes::p99_seconds));
    }
};
struct LiveStatus {
    std::string title;  // "" = no live scene
    std::uint32_t members = 0, views = 0;
    std::uint64_t edits = 0, transactions = 0, edit_bytes = 0;
    std::uint64_t versions = 0, change_bytes = 0;  // published; sent to all nodes together
    std::uint64_t journal_bytes = 0, checkpoints = 0;
    std::vector<StageTimes> stages;
    static constexpr auto describe(auto row) {
        return std::tuple(
            row(1, "title", &LiveStatus::title), row(2, "members", &LiveStatus::members),
            row(3, "views", &LiveStatus::views), row(4, "edits", &LiveStatus::edits),
            row(5, "transactions", &LiveStatus::transactions), row(6, "edit_bytes", &LiveStatus::edit_bytes),
            row(7, "versions", &LiveStatus::versions), row(8, "change_bytes", &LiveStatus::change_bytes),
            row(9, "journal_bytes", &LiveStatus::journal_bytes),
            row(10, "checkpoints", &LiveStatus::checkpoints), row(11, "stages", &LiveStatus::stages));
    }
};

}  // namespace tessera::wire
