#include "master/peers/roles.h"

namespace tessera::master {

namespace {

using net::Role;

constexpr unsigned bit(Role role) {
    return 1u << static_cast<unsigned>(role);
}
constexpr unsigned Nobody = 0;
constexpr unsigned Nodes = bit(Role::Node) | bit(Role::Operator);
constexpr unsigned Editors = bit(Role::Editor) | bit(Role::Operator);
constexpr unsigned Clients = bit(Role::Viewer) | Editors;
constexpr unsigned Everybody = Clients | Nodes;

struct SendersOf {
    unsigned operator()(const wire::Hello& hello) const {
        return hello.peer == wire::PeerKind::Node ? Nodes : Clients;
    }
    unsigned operator()(const wire::Heartbeat&) const { return Everybody; }
    unsigned operator()(const wire::Goodbye&) const { return Everybody; }
    unsigned operator()(const wire::VersionReport&) const { return Nodes; }
    unsigned operator()(const wire::Resync&) const { return Nodes; }
    unsigned operator()(const wire::SceneRefused&) const { return Nodes; }
    unsigned operator()(const wire::UnitReleased&) const { return Nodes; }
    unsigned operator()(const wire::Notice&) const { return Nodes; }
    unsigned operator()(const wire::OpenScene&) const { return Editors; }
    unsigned operator()(const wire::SubmitEdit&) const { return Editors; }
    unsigned operator()(const wire::SubmitEditByBlob&) const { return Editors; }
    unsigned operator()(const wire::StartJob&) const { return Editors; }
    unsigned operator()(const wire::StopJob&) const { return Editors; }
    unsigned operator()(const wire::StatusRequest&) const { return Clients; }
    unsigned operator()(const wire::SetFilter&) const { return Editors; }
    unsigned operator()(const wire::JoinScene&) const { return Clients; }
    unsigned operator()(const wire::CloseScene&) const { return Editors; }
    unsigned operator()(const wire::ReadScene&) const { return Clients; }
    unsigned operator()(const wire::LockObjects&) const { return Editors; }
    unsigned operator()(const wire::SetPresence&) const { return Clients; }
    unsigned operator()(const wire::ReadPeople&) const { return Clients; }
    unsigned operator()(const wire::ReadHistory&) const { return Clients; }
    unsigned operator()(const wire::ReadWriters&) const { return Clients; }
    unsigned operator()(const wire::OpenLiveView&) const { return Clients; }
    unsigned operator()(const wire::CloseLiveView&) const { return Clients; }
    unsigned operator()(const wire::FrameTaken&) const { return Clients; }
    unsigned operator()(const wire::Pick&) const { return Clients; }
    unsigned operator()(const wire::ReadTrace&) const { return Clients; }
    unsigned operator()(const wire::OpenDisplay&) const { return Editors; }
    unsigned operator()(const wire::CloseDisplay&) const { return Editors; }
    unsigned operator()(const wire::AdjustDisplay&) const { return Editors; }
    unsigned operator()(const wire::MoveHead&) const { return Editors; }
    unsigned operator()(const wire::JoinOutput&) const { return Clients; }
    unsigned operator()(const wire::OutputReady&) const { return Clients; }
    // What only a master says.
    unsigned operator()(const wire::Welcome&) const { return Nobody; }
    unsigned operator()(const wire::Refusal&) const { return Nobody; }
    unsigned operator()(const wire::Unknown&) const { return Nobody; }
    unsigned operator()(const wire::Changes&) const { return Nobody; }
    unsigned operator()(const wire::ChangesByBlob&) const { return Nobody; }
    unsigned operator()(const wire::OpenView&) const { return Nobody; }
    unsigned operator()(const wire::CloseView&) const { return Nobody; }
    unsigned operator()(const wire::Work&) const { return Nobody; }
    unsigned operator()(const wire::CancelUnits&) const { return Nobody; }
    unsigned operator()(const wire::Leave&) const { return Nobody; }
    unsigned operator()(const wire::QueuePlace&) const { return Nobody; }
    unsigned operator()(const wire::SceneOpened&) const { return Nobody; }
    unsigned operator()(const wire::EditReply&) const { return Nobody; }
    unsigned operator()(const wire::JobProgress&) const { return Nobody; }
    unsigned operator()(const wire::JobDone&) const { return Nobody; }
    unsigned operator()(const wire::StatusReply&) const { return Nobody; }
    unsigned operator()(const wire::FilterSet&) const { return Nobody; }
    unsigned operator()(const wire::SceneJoined&) const { return Nobody; }
    unsigned operator()(const wire::RequestDone&) const { return Nobody; }
    unsigned operator()(const wire::SceneContent&) const { return Nobody; }
    unsigned operator()(const wire::People&) const { return Nobody; }
    unsigned operator()(const wire::History&) const { return Nobody; }
    unsigned operator()(const wire::Writers&) const { return Nobody; }
    unsigned operator()(const wire::Picked&) const { return Nobody; }
    unsigned operator()(const wire::Trace&) const { return Nobody; }
    unsigned operator()(const wire::OutputOpened&) const { return Nobody; }
    unsigned operator()(const wire::PresentFrame&) const { return Nobody; }
    // bulk
    unsigned operator()(const wire::BulkHello&) const { return Everybody; }
    unsigned operator()(const wire::BlobRequest&) const { return Nodes | Clients; }
    unsigned operator()(const wire::BlobChunk&) const { return Editors; }
    unsigned operator()(const wire::BlobAbsent&) const { return Editors; }
    unsigned operator()(const wire::FilmPart&) const { return Nodes; }
    unsigned operator()(const wire::FrameTile&) const { return Nobody; }
    unsigned operator()(const wire::PictureChunk&) const { return Nobody; }
    unsigned operator()(const wire::LiveFrame&) const { return Nobody; }
    unsigned operator()(const wire::OutputPicture&) const { return Nobody; }
};

}  // namespace

bool allowed(net::Role role, const wire::ControlMessage& message) {
    return (std::visit(SendersOf{}, message) & bit(role)) != 0;
}

bool allowed(net::Role role, const wire::BulkMessage& message) {
    return (std::visit(SendersOf{}, message) & bit(role)) != 0;
}

}  // namespace tessera::master
