#include "client/tools/display/display_table.h"

#include <algorithm>
#include <cstdint>
#include <cstdio>

#include "client/tools/formatted.h"
#include "mediator/display/frustum.h"

namespace tessera::tools {

namespace {

std::string size_text(std::uint32_t width, std::uint32_t height) {
    return std::to_string(width) + "x" + std::to_string(height);
}

const char* eyes_text(display::Stereo stereo) {
    using enum display::Stereo;
    switch (stereo) {
        case Mono:
            return "mono";
        case Left:
            return "left";
        case Right:
            return "right";
        case Separate:
            return "separate";
        case SideBySide:
            return "side by side";
        case TopBottom:
            return "top/bottom";
        case InterlacedRows:
            return "rows";
        case AnaglyphPlain:
            return "anaglyph, plain";
        case AnaglyphDubois:
            break;
    }
    return "anaglyph";
}

std::string work_text(const display::Output& output) {
    std::string text;
    const auto add = [&](const char* word, bool is_done) {
        if (is_done) text += (text.empty() ? "" : ", ") + std::string(word);
    };
    const display::Blend& blend = output.blend;
    add("warp", !output.points.empty());
    add("soft edges", blend.left + blend.right + blend.top + blend.bottom > 0.0 || !blend.weights.empty());
    add("black lift", !blend.lift.empty());
    add("colour", output.color != display::Color{});
    add("turn", output.turn != display::Turn::None);
    return text.empty() ? "-" : text;
}

std::uint64_t rendered_pixels(const display::Output& output) {
    return std::uint64_t{output.view_width} * output.view_height * display::eyes(output.stereo).size();
}

// Half floats if the output process needs linear light, otherwise device bytes.
std::uint64_t frame_bytes(const display::Output& output) {
    return rendered_pixels(output) * (display::takes_linear_light(output) ? 6 : 3);
}

}  // namespace

std::string as_table(const display::Display& display) {
    std::size_t longest = 6;
    for (const display::Output& output : display.outputs) longest = std::max(longest, output.name.size());
    const int name_width = static_cast<int>(longest);
    std::string text = formatted("%-*s  %-11s  %-11s  %-15s  %8s  %10s  %s\n", name_width, "output", "device",
                                 "view", "eyes", "priority", "MB a frame", "work");
    std::uint64_t pixels = 0, bytes = 0, views = 0;
    for (const display::Output& output : display.outputs) {
        pixels += rendered_pixels(output);
        bytes += frame_bytes(output);
        views += display::eyes(output.stereo).size();
        text += formatted("%-*s  %-11s  %-11s  %-15s  %8u  %10.2f  ", name_width, output.name.c_str(),
                          size_text(output.width, output.height).c_str(),
                          size_text(output.view_width, output.view_height).c_str(), eyes_text(output.stereo),
                          output.priority, double(frame_bytes(output)) / 1e6) +
                work_text(output) + "\n";
    }
    text += formatted(
        "'%.80s': %zu output%s, %llu view%s, %.2f megapixels and %.2f MB a frame (%.0f MB/s at %g "
        "frames/s)\n",
        display.name.c_str(), display.outputs.size(), display.outputs.size() == 1 ? "" : "s",
        static_cast<unsigned long long>(views), views == 1 ? "" : "s", double(pixels) / 1e6,
        double(bytes) / 1e6, double(bytes) * display.rate / 1e6, display.rate);
    return text;
}

}  // namespace tessera::tools
