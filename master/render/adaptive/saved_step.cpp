#include "master/render/adaptive/saved_step.h"

#include <algorithm>
#include <map>
#include <set>

#include "mediator/frame/pixel_set.h"

namespace tessera::master {

std::vector<wire::SavedPart> saved_step(std::span<const Round> rounds, std::span<const Rect> tiles) {
    std::vector<wire::SavedPart> parts;
    for (const Round& round : rounds) {
        if (!round.masks) continue;
        for (std::size_t tile = 0; tile < tiles.size(); ++tile) {
            const RoundMask& mask = (*round.masks)[tile];
            if (mask.pixels > 0) parts.push_back({tiles[tile], round.block, mask.bits});
        }
    }
    return parts;
}

std::vector<Round> remaining_rounds(std::span<const wire::SavedPart> step, const FrameAssembler& film) {
    std::map<std::pair<std::uint32_t, std::size_t>, std::set<std::uint32_t>>
        left;  // pixels, by level and tile
    const std::vector<Rect>& tiles = film.tiles();
    for (const wire::SavedPart& part : step) {
        const auto tile = static_cast<std::size_t>(std::ranges::find(tiles, part.tile) - tiles.begin());
        const frame::SampleBlock& block = part.block;
        if (tile == tiles.size() || block.level >= 32 || block.first != block.count()) continue;
        const auto pixels = frame::PixelSet::from_bits(part.mask, part.tile.pixel_count());
        const std::vector<std::uint8_t> doublings = film.doublings(static_cast<std::uint32_t>(tile));
        if (!pixels || doublings.empty()) continue;
        for (std::size_t i = 0; i < pixels->count(doublings.size()); ++i) {
            if (const std::uint32_t pixel = pixels->index(i); doublings[pixel] == block.level)
                left[{block.level, tile}].insert(pixel);
        }
    }
    std::vector<Round> rounds;
    std::vector<RoundMask> masks(tiles.size());
    for (auto entry = left.begin(); entry != left.end();) {
        const auto [level, tile] = entry->first;
        const std::size_t all = tiles[tile].pixel_count();
        const frame::PixelSet pixels({entry->second.begin(), entry->second.end()}, all);
        masks[tile] = {pixels.bits(all), static_cast<std::uint32_t>(pixels.count(all))};
        if (++entry != left.end() && entry->first.first == level) continue;
        rounds.push_back({{std::uint64_t{1} << level, level},
                          std::make_shared<const std::vector<RoundMask>>(std::move(masks))});
        masks.assign(tiles.size(), {});
    }
    return rounds;
}

}  // namespace tessera::master
