#include "mediator/picture/film_state_layers.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <map>
#include <string>

#include "mediator/base/error.h"

namespace tessera::picture {

namespace {

Layer integers(const std::string& name, const std::string& component, const Rect& window,
               const std::vector<std::uint32_t>& values) {
    Layer layer{name, {component}, frame::Image(window.width, window.height, 1), true};
    std::memcpy(layer.image.values.data(), values.data(), values.size() * sizeof(std::uint32_t));
    return layer;
}

std::size_t index_of(const Rect& window, const Rect& tile, std::uint32_t pixel) {
    const auto width = static_cast<std::uint32_t>(tile.width);
    const auto x = static_cast<std::size_t>(tile.x - window.x) + pixel % width;
    const auto y = static_cast<std::size_t>(tile.y - window.y) + pixel / width;
    return y * static_cast<std::size_t>(window.width) + x;
}

// Copies count and planes of a pixel; `to` may have no planes.
void copy(const frame::FilmTile& from, std::size_t i, frame::FilmTile& to, std::size_t j) {
    to.counts[j] = from.counts[i];
    for (std::uint32_t plane = 0; plane < to.channels.plane_count(); ++plane)
        to.plane(plane)[j] = from.plane(plane)[i];
}

std::vector<PixelBlocks> pixel_blocks(const Rect& window, frame::ChannelSet channels,
                                      const std::vector<frame::FilmTile>& blocks) {
    std::vector<PixelBlocks> slots;
    std::vector<std::uint8_t> used(window.pixel_count(), 0);
    for (const frame::FilmTile& block : blocks) {
        for (std::size_t i = 0; i < block.pixel_count(); ++i) {
            const std::size_t pixel = index_of(window, block.rect, block.pixels.index(i));
            const std::size_t slot = used[pixel]++;
            if (slot == slots.size())
                slots.push_back({frame::FilmTile(window, {}, channels),
                                 std::vector<std::uint32_t>(used.size()),
                                 std::vector<std::uint32_t>(used.size())});
            copy(block, i, slots[slot].film, pixel);
            slots[slot].first[pixel] = static_cast<std::uint32_t>(block.block.first);
            slots[slot].size[pixel] = static_cast<std::uint32_t>(block.block.count());
        }
    }
    return slots;
}

// Whether each pixel has one block, whose bits are those of the film.
bool is_film(const frame::FilmTile& film, const std::vector<frame::FilmTile>& blocks) {
    std::size_t pixels = 0;
    for (const frame::FilmTile& block : blocks) {
        pixels += block.pixel_count();
        for (std::size_t i = 0; i < block.pixel_count(); ++i) {
            const std::size_t pixel = index_of(film.rect, block.rect, block.pixels.index(i));
            if (block.counts[i] != film.counts[pixel]) return false;
            for (std::uint32_t plane = 0; plane < film.channels.plane_count(); ++plane) {
                if (std::bit_cast<std::uint32_t>(block.plane(plane)[i]) !=
                    std::bit_cast<std::uint32_t>(film.plane(plane)[pixel]))
                    return false;
            }
        }
    }
    return pixels == film.pixel_count();
}

void add_planes(const std::string& name, const frame::FilmTile& film, std::vector<Layer>& layers) {
    layers.push_back(integers(name, "count", film.rect, film.counts));
    for (const frame::ChannelInfo& entry : frame::channel_table()) {
        if (film.channels.contains(entry.channel))
            layers.push_back(plane_layer(name + "." + std::string(entry.name), film, entry));
    }
}

[[noreturn]] void fail(const char* what) {
    throw Error(ErrorCode::InvalidInput,
                std::string("its blocks of samples ") + what + ": the file is damaged");
}

// The pixels of a tile by the block that they have in one slot.
using PixelsByBlock = std::map<frame::SampleBlock, std::vector<std::uint32_t>>;

PixelsByBlock group(const PixelBlocks& slot, const Rect& window, const Rect& tile) {
    PixelsByBlock groups;
    for (std::uint32_t i = 0; i < tile.pixel_count(); ++i) {
        const std::size_t pixel = index_of(window, tile, i);
        const std::uint32_t size = slot.size[pixel];
        if (size == 0) continue;
        if (!std::has_single_bit(size) || slot.first[pixel] % size != 0) fail("are not aligned");
        groups[{slot.first[pixel], static_cast<std::uint32_t>(std::countr_zero(size))}].push_back(i);
    }
    return groups;
}

frame::FilmTile cut(const PixelBlocks& slot, const Rect& window, const Rect& tile,
                    const frame::SampleBlock& block, std::vector<std::uint32_t>&& pixels) {
    frame::FilmTile film(tile, block, slot.film.channels,
                         frame::PixelSet(std::move(pixels), tile.pixel_count()));
    std::uint64_t accepted = 0;
    for (std::size_t i = 0; i < film.pixel_count(); ++i) {
        copy(slot.film, index_of(window, tile, film.pixels.index(i)), film, i);
        if (film.counts[i] > block.count()) fail("hold more samples than they have");
        accepted += film.counts[i];
    }
    film.nonfinite_samples = block.count() * film.pixel_count() - accepted;
    return film;
}

}  // namespace

Layer plane_layer(const std::string& name, const frame::FilmTile& film, const frame::ChannelInfo& entry) {
    const std::uint32_t count = entry.plane_count(), first = film.channels.first_plane(entry.channel);
    Layer layer{name, {}, frame::Image(film.rect.width, film.rect.height, count)};
    for (std::uint32_t plane = 0; plane < count; ++plane) {
        layer.components.push_back("p" + std::to_string(plane));
        const auto values = film.plane(first + plane);
        for (std::size_t i = 0; i < values.size(); ++i)
            std::memcpy(&layer.image.values[i * count + plane], &values[i], sizeof(float));
    }
    return layer;
}

std::vector<Layer> state_layers(const frame::FilmTile& film, const frame::FilmState& state) {
    std::vector<Layer> layers;
    // Without a copy of the planes in the usual case, since films are large.
    const bool needs_planes = !is_film(film, state.blocks);
    const std::vector<PixelBlocks> slots =
        pixel_blocks(film.rect, needs_planes ? film.channels : frame::ChannelSet(), state.blocks);
    for (std::size_t k = 0; k < slots.size(); ++k) {
        const std::string name = "blocks." + std::to_string(k);
        layers.push_back(integers(name, "first", film.rect, slots[k].first));
        layers.push_back(integers(name, "size", film.rect, slots[k].size));
        if (needs_planes) add_planes(name, slots[k].film, layers);
    }
    if (state.wanted.empty()) return layers;
    std::vector<std::uint32_t> wanted(film.rect.pixel_count(), 0);
    for (const frame::WantedSamples& samples : state.wanted) {
        for (std::size_t i = 0; i < samples.pixels.count(samples.tile.pixel_count()); ++i)
            wanted[index_of(film.rect, samples.tile, samples.pixels.index(i))] = 1;
    }
    layers.push_back(integers("wanted", "samples", film.rect, wanted));
    return layers;
}

frame::FilmState state_of(const std::vector<PixelBlocks>& blocks, const std::vector<std::uint32_t>& wanted,
                          std::uint32_t steps, std::uint32_t tile_edge) {
    frame::FilmState state{.blocks = {}, .steps = steps, .wanted = {}};
    const Rect& window = blocks.front().film.rect;
    const auto edge = static_cast<std::int32_t>(tile_edge);
    for (std::int32_t y = window.y; y < window.bottom(); y += edge) {
        for (std::int32_t x = window.x; x < window.right(); x += edge) {
            const Rect tile = intersection({x, y, edge, edge}, window);
            for (const PixelBlocks& slot : blocks) {
                for (auto& [block, pixels] : group(slot, window, tile))
                    state.blocks.push_back(cut(slot, window, tile, block, std::move(pixels)));
            }
            if (wanted.empty()) continue;
            for (auto& [block, pixels] : group(blocks.front(), window, tile)) {
                std::erase_if(pixels,
                              [&](std::uint32_t i) { return wanted[index_of(window, tile, i)] == 0; });
                if (!pixels.empty() && block.first == 0)
                    state.wanted.push_back(
                        {tile, block.sibling(), frame::PixelSet(std::move(pixels), tile.pixel_count())});
            }
        }
    }
    return state;
}

}  // namespace tessera::picture
