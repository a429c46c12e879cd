#include "tests/fuzz/film_generator.h"

#include <algorithm>
#include <limits>

namespace tessera::test {

void FilmGenerator::got(const view::WorkUnit& unit) {
    units_.push_back(unit);
    highest_ = std::max(highest_, unit.id.value);
    ++dealt_;
    if (units_.size() > 256) units_.pop_front();
}

void FilmGenerator::got(const wire::OpenView& view) {
    if (view.view.window.empty()) return;
    views_.push_back(view);
    if (views_.size() > 16) views_.pop_front();
}

UnitId FilmGenerator::some_unit() {
    if (!units_.empty() && random_.chance(50)) {
        const UnitId id = units_.front().id;
        if (random_.chance(70)) units_.pop_front();
        return id;
    }
    return UnitId{random_.chance(80) ? random_.below(highest_ + 64) : random_.extreme()};
}

std::vector<UnitId> FilmGenerator::units() const {
    std::vector<UnitId> ids;
    for (const view::WorkUnit& unit : units_) ids.push_back(unit.id);
    return ids;
}

// Plausible in all but that it was not dealt to this node: of a tile and block of a view that is open.
wire::FilmPart FilmGenerator::film_of_others() {
    const view::View& view = views_[random_.below(views_.size())].view;
    wire::FilmPart part{
        .unit = UnitId{random_.below(highest_ + 64)}, .view = view.id, .revision = view.revision};
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
