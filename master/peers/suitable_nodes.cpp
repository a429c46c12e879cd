#include "master/peers/suitable_nodes.h"

namespace tessera::master {

namespace {

// "no node has the renderer raster: ...; ", or "" if one has.
std::string missing_renderer(const NodeTable& nodes, view::Renderer renderer) {
    for (const auto& [id, node] : nodes.all()) {
        if (node.hello.renderers.contains(renderer)) return {};
    }
    if (renderer != view::Renderer::Raster) return {};
    return "no node has the renderer raster: start one with --backend vulkan; ";
}

// "the back-ends of 2 nodes do not give alpha, range; ", or "" if channels are not the cause.
std::string missing_channels(const NodeTable& nodes, frame::ChannelSet channels) {
    std::uint32_t lacking = 0;
    frame::ChannelSet missing;
    for (const auto& [id, node] : nodes.all()) {
        const frame::ChannelSet lacks = channels - node.hello.channels;
        lacking += lacks.empty() ? 0 : 1;
        missing = missing | lacks;
    }
    if (lacking == 0) return {};
    std::string names;
    for (const frame::ChannelInfo& entry : frame::channel_table()) {
        if (!missing.contains(entry.channel)) continue;
        names += (names.empty() ? "" : ", ") + std::string(entry.name);
    }
    return "the back-ends of " + std::to_string(lacking) + " nodes do not give " + names + "; ";
}

// "2 nodes cannot build the scene (node-1: why); ", or "" if none has refused it.
std::string refusals(const NodeTable& nodes, Version version) {
    std::uint32_t count = 0;
    std::string first;
    for (const auto& [id, node] : nodes.all()) {
        if (node.refused != version) continue;
        if (count++ == 0) first = node.hello.name + ": " + node.refusal;
    }
    if (count == 0) return {};
    return std::to_string(count) + (count == 1 ? " node" : " nodes") + " cannot build the scene (" + first +
           "); ";
}

}  // namespace

bool suits(const NodeRecord& node, const view::View& view, Version version) {
    const bool has_channels = node.hello.channels.contains(view.channels);
    return !node.leaving && !node.stuck && !node.quarantined && node.bulk && has_channels &&
           node.refused != version && node.hello.renderers.contains(view.renderer);
}

bool ready(const NodeRecord& node, const view::View& view, Version version) {
    return suits(node, view, version) && node.reported == version && node.state.version == version;
}

std::string obstacles(const NodeTable& nodes, const view::View& view, Version version) {
    return missing_renderer(nodes, view.renderer) + missing_channels(nodes, view.channels) +
           refusals(nodes, version);
}

}  // namespace tessera::master
