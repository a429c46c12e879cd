#include "master/render/adaptive/saved_step.h"

#include <algorithm>
#include <map>
#include <set>

#include "master/render/adaptive/step.h"
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
    // Sets, since a damaged folder may name pixels twice.
    std::map<PixelsByRound::key_type, std::set<std::uint32_t>> left;
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
    PixelsByRound pixels;
    for (const auto& [round, of_tile] : left) pixels[round] = {of_tile.begin(), of_tile.end()};
    return rounds_of(std::move(pixels), tiles);
}

std::vector<frame::WantedSamples> wanted_samples(std::span<const Round> step, const FrameAssembler& film,
                                                 std::uint32_t tile) {
    std::vector<frame::WantedSamples> wanted;
    const Rect& rect = film.tiles()[tile];
    const std::vector<std::uint8_t> doublings = film.doublings(tile);
    for (const Round& round : step) {
        if (doublings.empty() || !round.masks) continue;
        const RoundMask& mask = (*round.masks)[tile];
        if (mask.pixels == 0) continue;
        const frame::PixelSet pixels = *frame::PixelSet::from_bits(mask.bits, rect.pixel_count());
        std::vector<std::uint32_t> left;
        for (std::size_t i = 0; i < pixels.count(doublings.size()); ++i) {
            const std::uint32_t pixel = pixels.index(i);
            if (doublings[pixel] == round.block.level) left.push_back(pixel);
        }
        if (!left.empty())
            wanted.push_back({rect, round.block, frame::PixelSet(std::move(left), rect.pixel_count())});
    }
    return wanted;
}

std::vector<wire::SavedPart> saved_step(std::span<const frame::WantedSamples> wanted) {
    std::vector<wire::SavedPart> parts;
    for (const frame::WantedSamples& samples : wanted)
        parts.push_back({samples.tile, samples.block, samples.pixels.bits(samples.tile.pixel_count())});
    return parts;
}

}  // namespace tessera::master
