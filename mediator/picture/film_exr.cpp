#include "mediator/picture/film_exr.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfStringAttribute.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <map>
#include <new>

#include "mediator/base/description.h"
#include "mediator/base/error.h"
#include "mediator/base/old_names.h"
#include "mediator/frame/design_effect.h"
#include "mediator/frame/resolve.h"
#include "mediator/picture/exr_header.h"
#include "mediator/picture/film_state_layers.h"
#include "mediator/picture/noise_map.h"

namespace tessera::picture {

namespace {

const std::string Prefix = "statistics";

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

std::string plane_name(std::uint32_t plane) {
    return "p" + std::to_string(plane);
}

// Variance of the mean (of stratified samples, if the film has their block variance) and of single samples.
void add_variances(const frame::FilmTile& film, std::vector<Layer>& layers) {
    const std::vector<std::string> rgb{"R", "G", "B"};
    Layer mean{"variance", rgb, frame::resolve_variance_of_mean(film, frame::Channel::Radiance)};
    Layer sample{"sample_variance", rgb, mean.image};
    frame::DesignEffect design_effect;
    const std::span<const float> effect = design_effect.measure(film);
    for (std::size_t i = 0; i < effect.size(); ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
            mean.image.values[3 * i + c] *= effect[i];
            sample.image.values[3 * i + c] *= static_cast<float>(film.counts[i]);
        }
    }
    layers.push_back(std::move(mean));
    layers.push_back(std::move(sample));
}

// As adaptive sampling sees it.
Layer noise_layer(const frame::FilmTile& film) {
    Layer layer{"noise", {"Y"}, frame::Image(film.rect.width, film.rect.height, 1)};
    layer.image.values = noise_of_pixels(film);
    return layer;
}

std::vector<std::string> component_names(const frame::ChannelInfo& entry) {
    if (entry.channel == frame::Channel::Normal) return {"X", "Y", "Z"};
    if (entry.channel == frame::Channel::Depth) return {"Z"};
    if (entry.components == 1) return {"Y"};
    return {"R", "G", "B"};
}

// Reads a channel of the file into a plane; EXR needs the address of pixel (0, 0).
void take(Imf::FrameBuffer& target, const std::string& name, Imf::PixelType type, void* values,
          const Rect& window) {
    constexpr std::ptrdiff_t X = sizeof(float);
    const std::ptrdiff_t y = X * window.width;
    char* origin = static_cast<char*>(values) - window.x * X - window.y * y;
    target.insert(name, Imf::Slice(type, origin, X, static_cast<std::size_t>(y)));
}

FilmFile read(const std::string& path) {
    FilmFile result;
    const Rect window = checked_exr_window(path);
    Imf::InputFile input(path.c_str(), 0);
    const Imf::Header& header = input.header();
    result.width = static_cast<std::uint32_t>(header.displayWindow().max.x + 1);
    result.height = static_cast<std::uint32_t>(header.displayWindow().max.y + 1);
    const auto holds = [&](const std::string& name, Imf::PixelType type) {
        const Imf::Channel* channel = header.channels().findChannel(name);
        return channel != nullptr && channel->type == type && channel->xSampling == 1 &&
               channel->ySampling == 1;
    };
    frame::ChannelSet channels;
    std::map<frame::Channel, std::string> layers;  // of the statistics
    for (const frame::ChannelInfo& entry : frame::channel_table()) {
        for (const std::string_view name :
             {entry.name, old_name("channel", entry.name).value_or(entry.name)}) {
            const std::string layer = Prefix + "." + std::string(name) + ".";
            bool all = true;
            for (std::uint32_t plane = 0; plane < entry.plane_count(); ++plane)
                all = all && holds(layer + plane_name(plane), Imf::FLOAT);
            if (!all) continue;
            channels.insert(entry.channel);
            layers.try_emplace(entry.channel, layer);
        }
    }
    const bool has_picture =
        channels.contains(frame::Channel::Radiance) || channels.contains(frame::Channel::Color);
    if (!has_picture || !holds("samples.count", Imf::UINT)) {
        throw Error(ErrorCode::InvalidInput, "it has no statistics: render it again with --save-statistics");
    }
    result.film = frame::FilmTile(window, {}, channels);
    Imf::FrameBuffer target;
    take(target, "samples.count", Imf::UINT, result.film.counts.data(), window);
    for (const frame::ChannelInfo& entry : frame::channel_table()) {
        if (!channels.contains(entry.channel)) continue;
        const std::uint32_t first = channels.first_plane(entry.channel);
        for (std::uint32_t plane = 0; plane < entry.plane_count(); ++plane) {
            take(target, layers.at(entry.channel) + plane_name(plane), Imf::FLOAT,
                 result.film.plane(first + plane).data(), window);
        }
    }
    input.setFrameBuffer(target);
    input.readPixels(window.y, window.bottom() - 1);
    for (auto attribute = header.begin(); attribute != header.end(); ++attribute) {
        const auto* text = dynamic_cast<const Imf::StringAttribute*>(&attribute.attribute());
        if (text != nullptr) result.attributes[attribute.name()] = text->value();
    }
    return result;
}

constexpr const char* TileSize = "tessera.tileSize";
constexpr const char* Steps = "tessera.steps";

void add_state(const frame::FilmTile& film, const frame::FilmState& state, std::vector<Layer>& layers,
               std::map<std::string, std::string>& attributes) {
    for (Layer& layer : state_layers(film, state)) layers.push_back(std::move(layer));
    std::int32_t edge = 1;
    for (const frame::FilmTile& block : state.blocks)
        edge = std::max({edge, block.rect.width, block.rect.height});
    attributes[TileSize] = std::to_string(edge);
    if (state.steps > 0) attributes[Steps] = std::to_string(state.steps);
}

// Of a file that has one.
std::optional<frame::FilmState> read_state(const std::string& path, const FilmFile& file) {
    Imf::InputFile input(path.c_str(), 0);
    const Imf::ChannelList& channels = input.header().channels();
    const auto holds = [&](const std::string& name, Imf::PixelType type) {
        const Imf::Channel* channel = channels.findChannel(name);
        return channel != nullptr && channel->type == type && channel->xSampling == 1 &&
               channel->ySampling == 1;
    };
    const auto number = [&](const char* name) -> std::uint32_t {
        const auto found = file.attributes.find(name);
        return found == file.attributes.end()
                   ? 0
                   : static_cast<std::uint32_t>(std::strtoul(found->second.c_str(), nullptr, 10));
    };
    const std::uint32_t edge = number(TileSize);
    if (edge == 0 || edge > 256) return std::nullopt;
    const frame::FilmTile& film = file.film;
    constexpr std::size_t MaxBlocks = 64;  // of a pixel: one for each power of two, twice
    std::vector<PixelBlocks> blocks;
    std::vector<std::uint32_t> wanted;
    Imf::FrameBuffer target;
    while (blocks.size() < MaxBlocks) {
        const std::string name = "blocks." + std::to_string(blocks.size());
        if (!holds(name + ".first", Imf::UINT) || !holds(name + ".size", Imf::UINT)) break;
        const bool has_planes = holds(name + ".count", Imf::UINT);
        const std::vector<std::uint32_t> none(film.pixel_count());
        PixelBlocks& slot = blocks.emplace_back(PixelBlocks{film, none, none});
        take(target, name + ".first", Imf::UINT, slot.first.data(), film.rect);
        take(target, name + ".size", Imf::UINT, slot.size.data(), film.rect);
        if (!has_planes) continue;  // the film's own
        take(target, name + ".count", Imf::UINT, slot.film.counts.data(), film.rect);
        for (const frame::ChannelInfo& entry : frame::channel_table()) {
            if (!film.channels.contains(entry.channel)) continue;
            const std::uint32_t first = film.channels.first_plane(entry.channel);
            for (std::uint32_t plane = 0; plane < entry.plane_count(); ++plane) {
                const std::string of_plane = name + "." + std::string(entry.name) + "." + plane_name(plane);
                if (!holds(of_plane, Imf::FLOAT)) return std::nullopt;
                take(target, of_plane, Imf::FLOAT, slot.film.plane(first + plane).data(), film.rect);
            }
        }
    }
    if (blocks.empty()) return std::nullopt;
    if (holds("wanted.samples", Imf::UINT)) {
        wanted.resize(film.pixel_count());
        take(target, "wanted.samples", Imf::UINT, wanted.data(), film.rect);
    }
    input.setFrameBuffer(target);
    input.readPixels(film.rect.y, film.rect.bottom() - 1);
    return state_of(blocks, wanted, number(Steps), edge);
}

// Checks what filters rely on (mediator/filter/inputs.h), since a file may contain anything.
void check(const frame::FilmTile& film) {
    for (const frame::ChannelInfo& entry : frame::channel_table()) {
        if (!film.channels.contains(entry.channel) || entry.rule == frame::MergeRule::Nearest) continue;
        const std::uint32_t first = film.channels.first_plane(entry.channel);
        const bool may_be_infinite = entry.rule == frame::MergeRule::Minimum;
        for (std::uint32_t plane = 0; plane < entry.plane_count(); ++plane) {
            const bool is_negative_damage = plane >= entry.components ||  // sums of squared deviations
                                            entry.rule == frame::MergeRule::BlockVariance ||
                                            (entry.rule == frame::MergeRule::FirstHalf && plane == 3);
            for (const float value : film.plane(first + plane)) {
                const bool is_valid = std::isfinite(value) || (may_be_infinite && value > 0.0f);
                if (!is_valid || (is_negative_damage && value < 0.0f)) {
                    throw Error(ErrorCode::InvalidInput,
                                "channel " + std::string(entry.name) +
                                    " holds a value that no film has: the file is damaged");
                }
            }
        }
    }
}

}  // namespace

std::vector<Layer> film_layers(const frame::FilmTile& film, const std::optional<frame::Image>& filtered) {
    using frame::Channel;
    const std::vector<std::string> rgb{"R", "G", "B"};
    const Channel picture = film.channels.contains(Channel::Radiance) ? Channel::Radiance : Channel::Color;
    std::vector<Layer> layers;
    if (filtered) {
        layers.push_back(
            {"", filtered->components == 4 ? std::vector<std::string>{"R", "G", "B", "A"} : rgb, *filtered});
    }
    for (const frame::ChannelInfo& entry : frame::channel_table()) {
        if (!film.channels.contains(entry.channel)) continue;
        if (entry.channel == Channel::ObjectIndex) {
            layers.push_back(object_layer(film));
        } else if (entry.channel == picture) {
            layers.push_back({filtered ? "raw" : "", rgb, frame::resolve_picture(film)});
            if (picture != Channel::Radiance) continue;
            add_variances(film, layers);
            layers.push_back(noise_layer(film));
        } else if (entry.channel == Channel::Alpha && !filtered) {
            layers.push_back({"", {"A"}, frame::resolve(film, Channel::Alpha)});
        } else if (entry.channel != Channel::HalfBufferA && !entry.is_derived()) {
            layers.push_back(
                {std::string(entry.name), component_names(entry), frame::resolve(film, entry.channel)});
        }
    }
    layers.push_back(counts_layer(film));
    return layers;
}

void write_film_exr(const std::string& path, const FilmFile& file,
                    const std::optional<frame::Image>& filtered, Statistics statistics,
                    const std::vector<Layer>& more) {
    using frame::Channel;
    const frame::FilmTile& film = file.film;
    std::vector<Layer> layers = film_layers(film, filtered);
    std::map<std::string, std::string> attributes = file.attributes;
    for (const frame::ChannelInfo& entry : frame::channel_table()) {
        if (!film.channels.contains(entry.channel)) continue;
        attributes["tessera/merge/" + std::string(entry.name)] = std::string(enumerator_name(entry.rule));
        if (statistics == Statistics::Include)
            layers.push_back(plane_layer(Prefix + "." + std::string(entry.name), film, entry));
    }
    if (film.channels.contains(Channel::Radiance))
        attributes["tessera.varianceOf"] =
            film.channels.contains(Channel::BlockVariance) ? "mean-stratified" : "mean-independent";
    if (statistics == Statistics::Include && file.state) add_state(film, *file.state, layers, attributes);
    layers.insert(layers.end(), more.begin(), more.end());
    write_exr(path, file.width, file.height, film.rect, layers, attributes);
}

FilmFile read_film_exr(const std::string& path, State state) {
    const std::string named = "film '" + path + "': ";
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored)) {
        throw Error(ErrorCode::NotFound, named + "there is no such file: check the name");
    }
    if (!std::filesystem::is_regular_file(path, ignored)) {
        throw Error(ErrorCode::InvalidInput, named + "it is not a regular file: name a file");
    }
    try {
        FilmFile file = read(path);
        check(file.film);
        if (state == State::Included) file.state = read_state(path, file);
        return file;
    } catch (const Error& error) {
        throw Error(error.code(), named + error.what());
    } catch (const std::bad_alloc&) {
        throw Error(ErrorCode::OutOfMemory, named + "it does not fit into memory: crop it");
    } catch (const std::exception& error) {  // from OpenEXR
        throw Error(ErrorCode::InvalidInput,
                    named + "it cannot be read (" + error.what() + "): write it again");
    }
}

}  // namespace tessera::picture
