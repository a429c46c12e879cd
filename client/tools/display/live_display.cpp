#include "client/tools/display/live_display.h"

#include "client/tools/cluster_options.h"

namespace tessera::tools {

DisplayMember join_display(const client::Address& address, const std::string& name, const Clock& clock,
                           std::stop_token stop) {
    const auto blobs = std::make_shared<scene::BlobStore>();
    client::SessionSettings settings = session_settings(name, std::move(stop));
    settings.mirrors_scene = false;
    DisplayMember member{{}, client::connect(address, blobs, clock, settings)};
    member.display = member.session->status().display.name;
    if (member.display.empty())
        throw Error(ErrorCode::Refused, "no display is open: open one with tessera display open");
    const auto outcome = member.session->join({.when_busy = client::WhenBusy::GiveUp}, {});
    if (const auto* busy = std::get_if<client::Busy>(&outcome)) throw Error(ErrorCode::Refused, busy->reason);
    return member;
}

}  // namespace tessera::tools
