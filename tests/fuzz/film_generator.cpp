#include "tests/fuzz/film_generator.h"

#include <algorithm>
#include <iterator>
#include <limits>

namespace tessera::test {

void FilmGenerator::add(const view::WorkUnit& unit) {
    units_.push_back(unit);
    dealt_.insert(unit.id);
    highest_unit_ = std::max(highest_unit_, unit.id.value);
    if (units_.size() > 256) units_.pop_front();
}

void FilmGenerator::add(const wire::OpenView& view) {
    if (view.view.window.empty()) return;
    views_.push_back(view);
    if (views_.size() > 16) views_.pop_front();
}

// Half of the time the same again: one failure alone is not yet believed. Else one of the first units of the latest known
// pass, or of one that began since; the ids of a pass begin at a multiple of 2^32.
UnitId FilmGenerator::unit_of_others() {
    if (random_.chance(50) && latest_of_others_.value != 0 && !dealt_.contains(latest_of_others_))
        return latest_of_others_;
    do {
        const std::uint64_t pass = (highest_unit_ >> 32) + (random_.chance(50) ? 0 : random_.below(8));
        latest_of_others_ = UnitId{random_.chance(90) ? (pass << 32) + random_.below(32) : random_.extreme()};
    } while (dealt_.contains(latest_of_others_));
    return latest_of_others_;
}

wire::UnitReleased FilmGenerator::release(bool may_fail) {
    using enum wire::ReleaseReason;
    constexpr wire::ReleaseReason Others[] = {Cancelled, OtherVersion, UnknownView, Leaving};
    wire::UnitReleased release{.unit = {}, .reason = Failed, .message = random_.name("it failed")};
    if (random_.chance(50)) release.reason = Others[random_.below(std::size(Others))];
    if (!units_.empty() && random_.chance(40) && (may_fail || release.reason != Failed)) {
        release.unit = units_.front().id;
        if (random_.chance(70)) units_.pop_front();
    } else {
        release.unit = unit_of_others();
    }
    return release;
}

std::vector<UnitId> FilmGenerator::units() const {
    std::vector<UnitId> ids;
    for (const view::WorkUnit& unit : units_) ids.push_back(unit.id);
    return ids;
}

// Plausible in all but that it was not dealt to this node: of a tile and block of a view that is open.
wire::FilmPart FilmGenerator::film_of_others() {
    const view::View& view = views_[random_.below(views_.size())].view;
    wire::FilmPart part;
    part.unit = unit_of_others();
    part.view = view.id;
    part.revision = view.revision;
    const std::int32_t side = random_.chance(50) ? 32 : 16;
    const auto start = [&](std::int32_t low, std::int32_t size) {
        const auto tiles = static_cast<std::uint64_t>((size + side - 1) / side);
        return low + side * static_cast<std::int32_t>(random_.below(tiles));
    };
    const Rect& window = view.window;
    const Rect tile{start(window.x, window.width), start(window.y, window.height), side, side};
    const auto level = static_cast<std::uint32_t>(random_.below(5));
    part.film = frame::FilmTile(intersection(tile, window), {random_.below(16u >> level) << level, level},
                                view.channels);
    std::ranges::fill(part.film.counts, 1u << level);
    return part;
}

wire::FilmPart FilmGenerator::film(Version version, bool may_forge) {
    wire::FilmPart part;
    if (units_.empty() || random_.chance(20)) {
        if (!views_.empty() && random_.chance(80)) {
            part = film_of_others();
            part.version = version;
            return part;
        }
        part.unit = UnitId{random_.extreme()};
        part.view = ViewId{random_.extreme()};
        part.film = frame::FilmTile({0, 0, 8, 8}, {0, 1}, {frame::Channel::Radiance});
        return part;
    }
    const view::WorkUnit unit = units_.front();
    if (random_.chance(70)) units_.pop_front();
    part.unit = unit.id;
    part.view = unit.view;
    part.revision = unit.revision;
    part.version = version;
    part.units = static_cast<std::uint32_t>(random_.chance(90) ? 1 : random_.extreme());
    part.rays = random_.extreme();
    part.busy_ns = random_.extreme();
    frame::ChannelSet channels{frame::Channel::Radiance};
    for (const wire::OpenView& view : views_) {
        if (view.view.id == unit.view) channels = view.view.channels;
    }
    part.film = frame::FilmTile(unit.tile, unit.block, channels);
    if (!may_forge || random_.chance(50))
        std::ranges::fill(part.film.planes, std::numeric_limits<float>::quiet_NaN());
    return part;
}

}  // namespace tessera::test
