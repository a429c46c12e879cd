#include "mediator/picture/exr_writer.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>

#include <cstring>
#include <exception>

#include "mediator/base/error.h"
#include "mediator/frame/resolve.h"
#include "mediator/picture/atomic_file.h"

namespace tessera::picture {

namespace {

const char* text(frame::MergeRule rule) {
    switch (rule) {
        case frame::MergeRule::Moments:
            return "moments";
        case frame::MergeRule::Sum:
            return "sum";
        case frame::MergeRule::Minimum:
            return "minimum";
        case frame::MergeRule::Maximum:
            return "maximum";
        case frame::MergeRule::Nearest:
            return "nearest";
        case frame::MergeRule::First:
            return "first";
    }
    return "";
}

std::string channel_name(const Layer& layer, std::size_t component) {
    return (layer.name.empty() ? "" : layer.name + ".") + layer.components[component];
}

// One plane per channel, with the address that EXR wants: of pixel (0, 0), which may lie outside the window.
void insert(Imf::FrameBuffer& frame_buffer, const Layer& layer, const Rect& window) {
    const std::size_t x_stride = layer.image.components * sizeof(float);
    const std::size_t y_stride = x_stride * layer.image.width;
    for (std::size_t c = 0; c < layer.components.size(); ++c) {
        const char* first = reinterpret_cast<const char*>(layer.image.values.data() + c);
        char* origin = const_cast<char*>(first) - window.x * static_cast<std::ptrdiff_t>(x_stride) -
                       window.y * static_cast<std::ptrdiff_t>(y_stride);
        frame_buffer.insert(channel_name(layer, c), Imf::Slice(layer.as_integers ? Imf::UINT : Imf::FLOAT,
                                                               origin, x_stride, y_stride));
    }
}

Layer counts_layer(const frame::FilmTile& film) {
    Layer layer{"samples", {"count"}, frame::resolve_counts(film), true};
    std::memcpy(layer.image.values.data(), film.counts.data(), film.counts.size() * sizeof(std::uint32_t));
    return layer;
}

Layer object_layer(const frame::FilmTile& film) {
    const frame::Image nearest = frame::resolve(film, frame::Channel::ObjectIndex);
    Layer layer{"object_id", {"id"}, frame::Image(nearest.width, nearest.height, 1), true};
    for (std::size_t i = 0; i < nearest.pixel_count(); ++i) {
        std::memcpy(&layer.image.values[i], &nearest.values[2 * i + 1], sizeof(float));
    }
    return layer;
}

}  // namespace

void write_exr(const std::string& path, std::uint32_t width, std::uint32_t height, const Rect& window,
               const std::vector<Layer>& layers, const std::map<std::string, std::string>& attributes) {
    write_atomically(path, [&](const std::string& temporary) {
        try {
            const Imath::Box2i display({0, 0}, {static_cast<int>(width) - 1, static_cast<int>(height) - 1});
            const Imath::Box2i data({window.x, window.y}, {window.right() - 1, window.bottom() - 1});
            Imf::Header header(display, data);
            header.compression() = Imf::ZIP_COMPRESSION;
            for (const auto& [name, value] : attributes) header.insert(name, Imf::StringAttribute(value));
            Imf::FrameBuffer frame_buffer;
            for (const Layer& layer : layers) {
                for (std::size_t c = 0; c < layer.components.size(); ++c) {
                    header.channels().insert(channel_name(layer, c),
                                             Imf::Channel(layer.as_integers ? Imf::UINT : Imf::FLOAT));
                }
                insert(frame_buffer, layer, window);
            }
            Imf::OutputFile file(temporary.c_str(), header);
            file.setFrameBuffer(frame_buffer);
            file.writePixels(window.height);
        } catch (const std::exception& error) {
            throw Error(ErrorCode::Io, "cannot write '" + path + "': " + error.what());
        }
    });
}

void write_film_exr(const std::string& path, std::uint32_t width, std::uint32_t height,
                    const frame::FilmTile& film, std::map<std::string, std::string> attributes) {
    using frame::Channel;
    const std::vector<std::string> rgb{"R", "G", "B"};
    std::vector<Layer> layers;
    const auto add = [&](Channel channel, const char* name, const std::vector<std::string>& components) {
        if (!film.channels.contains(channel)) return;
        layers.push_back({name, components, frame::resolve(film, channel)});
    };
    add(Channel::Radiance, "", rgb);
    add(Channel::LowVariance, "low_variance", rgb);
    add(Channel::HighVariance, "high_variance", rgb);
    add(Channel::Albedo, "albedo", rgb);
    add(Channel::Normal, "normal", {"X", "Y", "Z"});
    add(Channel::Depth, "depth", {"Z"});
    if (film.channels.contains(Channel::Radiance)) {
        layers.push_back({"variance", rgb, frame::resolve_variance_of_mean(film, Channel::Radiance)});
    }
    if (film.channels.contains(Channel::ObjectIndex)) layers.push_back(object_layer(film));
    layers.push_back(counts_layer(film));
    for (const frame::ChannelInfo& entry : frame::channel_table()) {
        if (film.channels.contains(entry.channel)) {
            attributes["tessera/merge/" + std::string(entry.name)] = text(entry.rule);
        }
    }
    write_exr(path, width, height, film.rect, layers, attributes);
}

}  // namespace tessera::picture
