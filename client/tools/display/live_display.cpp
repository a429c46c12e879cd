#include "client/tools/display/live_display.h"

#include "client/tools/cluster_options.h"

namespace tessera::tools {

DisplayMember join_display(const client::Address& address, const std::string& name, const Clock& clock) {
    const auto blobs = std::make_shared<scene::BlobStore>();
    client::SessionSettings settings = session_settings(name);
    settings.mirrors_scene = false;
    const std::string display = client::connect(address, blobs, clock, settings)->status().display.name;
    if (display.empty())
        throw Error(ErrorCode::Refused, "no display is open: open one with tessera display open");
    DisplayMember member{display, client::connect_live(address, blobs, clock, settings)};
    const auto outcome = member.session->join("", client::WhenBusy::GiveUp, nullptr, {});
    if (const auto* busy = std::get_if<client::Busy>(&outcome)) throw Error(ErrorCode::Refused, busy->reason);
    return member;
}

}  // namespace tessera::tools
