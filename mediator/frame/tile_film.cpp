#include "mediator/frame/tile_film.h"

#include <algorithm>
#include <bit>
#include <map>

#include "mediator/frame/merge.h"

namespace tessera::frame {

namespace {

// The block [2^k, 2^(k + 1)) that contains the beginning of `block`, which is not 0.
SampleBlock range_of(const SampleBlock& block) {
    const auto level = static_cast<std::uint32_t>(std::bit_width(block.first) - 1);
    return {std::uint64_t{1} << level, level};
}

bool have_common_pixels(const PixelSet& a, const PixelSet& b) {
    if (a.is_all() || b.is_all()) return true;
    const auto in_b = [&](std::uint32_t index) { return std::ranges::binary_search(b.indices(), index); };
    return std::ranges::any_of(a.indices(), in_b);
}

void count(const BlockForest& forest, std::size_t& bytes) {
    for (const auto& [first, block] : forest.blocks()) bytes += block.byte_size();
}

}  // namespace

TileFilm::Outcome TileFilm::insert(FilmTile block,
                                   const std::function<bool(const SampleBlock&)>& may_replace) {
    if (doublings_.empty() && block.pixels.is_all()) {
        const auto is_of_some = [&](const Part& part) { return part.range.contains(block.block); };
        if (std::ranges::any_of(parts_, is_of_some)) return Outcome::Overlap;
        const Outcome outcome = all_.insert(std::move(block), may_replace);
        take_complete_parts();
        return outcome;
    }
    return block.block.first == 0 ? insert_first(std::move(block))
                                  : insert_part(std::move(block), may_replace);
}

// False: the samples of all pixels are not one block.
bool TileFilm::begin_doubling(std::uint8_t none_or_level) {
    if (!doublings_.empty()) return true;
    if (none_or_level != None) {
        const auto& blocks = all_.blocks();
        if (blocks.size() != 1 || blocks.begin()->second.block != SampleBlock{0, none_or_level}) return false;
        film_ = blocks.begin()->second;
        all_ = {};
    }
    doublings_.assign(film_.rect.pixel_count(), none_or_level);
    return true;
}

bool TileFilm::all_have(const PixelSet& pixels, std::uint8_t doublings) const {
    for (std::size_t i = 0; i < pixels.count(doublings_.size()); ++i) {
        if (doublings_[pixels.index(i)] != doublings) return false;
    }
    return true;
}

// The samples of some pixels from 0 on: of a film that was saved.
TileFilm::Outcome TileFilm::insert_first(FilmTile block) {
    if (!all_.blocks().empty()) return Outcome::Overlap;
    if (doublings_.empty()) film_ = FilmTile(block.rect, block.block, block.channels);
    begin_doubling(None);
    const auto level = static_cast<std::uint8_t>(block.block.level);
    if (!all_have(block.pixels, None)) {
        const auto has_more = [&](std::size_t i) {
            const std::uint8_t has = doublings_[block.pixels.index(i)];
            return has != None && has >= level;
        };
        for (std::size_t i = 0; i < block.pixel_count(); ++i) {
            if (!has_more(i)) return Outcome::Overlap;
        }
        return Outcome::Duplicate;
    }
    paste(film_, block);
    for (std::size_t i = 0; i < block.pixel_count(); ++i) doublings_[block.pixels.index(i)] = level;
    take_complete_parts();
    return Outcome::Merged;
}

TileFilm::Outcome TileFilm::insert_part(FilmTile block,
                                        const std::function<bool(const SampleBlock&)>& may_replace) {
    const SampleBlock range = range_of(block.block);
    if (!range.contains(block.block)) return Outcome::Overlap;
    if (!doublings_.empty()) {
        std::size_t known = 0;
        for (std::size_t i = 0; i < block.pixel_count(); ++i) {
            const std::uint8_t has = doublings_[block.pixels.index(i)];
            known += has != None && has > range.level;
        }
        if (known > 0) return known == block.pixel_count() ? Outcome::Duplicate : Outcome::Overlap;
    } else if (all_.covers(block.block)) {
        return Outcome::Duplicate;
    }
    const auto is_same = [&](const Part& part) { return part.range == range && part.pixels == block.pixels; };
    auto part = std::ranges::find_if(parts_, is_same);
    if (part == parts_.end()) {
        const auto overlaps = [&](const Part& other) {
            return other.range == range && have_common_pixels(other.pixels, block.pixels);
        };
        if (std::ranges::any_of(parts_, overlaps)) return Outcome::Overlap;
        part = parts_.insert(part, {range, block.pixels, {}});
    }
    const Outcome outcome = part->blocks.insert(std::move(block), may_replace);
    take_complete_parts();
    return outcome;
}

// Adds the parts whose blocks are complete to the pixels, in the order of their samples.
void TileFilm::take_complete_parts() {
    std::ranges::stable_sort(parts_, std::less<>(), &Part::range);
    std::erase_if(parts_, [&](const Part& part) {
        const auto level = static_cast<std::uint8_t>(part.range.level);
        if (part.blocks.blocks().begin()->second.block != part.range) return false;
        if (!begin_doubling(level) || !all_have(part.pixels, level)) return false;
        add(film_, part);
        for (std::size_t i = 0; i < part.pixels.count(doublings_.size()); ++i)
            ++doublings_[part.pixels.index(i)];
        return true;
    });
}

void TileFilm::add(FilmTile& film, const Part& part) const {
    FilmTile some = with_pixels(film, part.pixels);
    some.block = part.range.sibling();
    for (const auto& [first, block] : part.blocks.blocks()) merge(some, block);
    paste(film, some);
}

FilmTile TileFilm::merged() const {
    FilmTile film = doublings_.empty() ? all_.merged() : film_;
    const bool is_one_block = doublings_.empty() && all_.blocks().size() == 1;
    for (const Part& part : parts_) {
        const bool can_be_added = doublings_.empty()
                                      ? is_one_block && film.block == part.range.sibling()
                                      : all_have(part.pixels, static_cast<std::uint8_t>(part.range.level));
        if (can_be_added) add(film, part);
    }
    return film;
}

const FilmTile* TileFilm::only_block() const {
    return doublings_.empty() && parts_.empty() && all_.blocks().size() == 1 ? &all_.blocks().begin()->second
                                                                             : nullptr;
}

std::vector<std::uint8_t> TileFilm::doublings() const {
    if (!doublings_.empty()) return doublings_;
    const FilmTile& base = all_.blocks().begin()->second;
    return std::vector(base.pixel_count(), static_cast<std::uint8_t>(base.block.level));
}

std::vector<FilmTile> TileFilm::blocks(Parts parts) const {
    std::vector<FilmTile> all;
    for (const auto& [first, block] : all_.blocks()) all.push_back(block);
    std::map<std::uint8_t, std::vector<std::uint32_t>> pixels;
    for (std::uint32_t i = 0; i < doublings_.size(); ++i) {
        if (doublings_[i] != None) pixels[doublings_[i]].push_back(i);
    }
    for (auto& [level, indices] : pixels) {
        FilmTile block = with_pixels(film_, PixelSet(std::move(indices), doublings_.size()));
        block.block = {0, level};
        std::uint64_t accepted = 0;
        for (const std::uint32_t count : block.counts) accepted += count;
        block.nonfinite_samples = block.block.count() * block.pixel_count() - accepted;
        all.push_back(std::move(block));
    }
    if (parts == Parts::LeftOut) return all;
    for (const Part& part : parts_) {
        for (const auto& [first, block] : part.blocks.blocks()) all.push_back(block);
    }
    return all;
}

std::size_t TileFilm::byte_size() const {
    std::size_t bytes = film_.byte_size() + doublings_.size();
    count(all_, bytes);
    for (const Part& part : parts_) count(part.blocks, bytes);
    return bytes;
}

}  // namespace tessera::frame
