#include "node/held_film.h"

#include <algorithm>
#include <utility>

#include "mediator/frame/merge.h"

namespace tessera::node {

namespace {

bool are_halves(const wire::FilmPart& a, const wire::FilmPart& b) {
    return a.view == b.view && a.revision == b.revision && a.version == b.version &&
           a.film.rect == b.film.rect && a.film.pixels == b.film.pixels &&
           a.film.channels == b.film.channels && a.film.block == b.film.block.sibling();
}

// Into the earlier half.
void join(HeldFilm::Item& into, HeldFilm::Item&& other) {
    if (other.film.film.block.first < into.film.film.block.first) std::swap(into.film, other.film);
    frame::merge(into.film.film, other.film.film);
    into.film.units += other.film.units;
    into.film.rays += other.film.rays;
    into.film.busy_ns += other.film.busy_ns;
    into.units.insert(into.units.end(), other.units.begin(), other.units.end());
    into.since = std::min(into.since, other.since);
}

}  // namespace

bool is_in_other_half(const wire::FilmPart& film, const view::WorkUnit& unit) {
    return unit.view == film.view && unit.revision == film.revision && unit.version == film.version &&
           unit.tile == film.film.rect && film.film.block.sibling().contains(unit.block) &&
           unit.pixels() == film.film.pixels;
}

void HeldFilm::add(wire::FilmPart film, TimePoint now) {
    Item item{.film = std::move(film), .units = {}, .since = now};
    item.units.push_back(item.film.unit);
    for (auto half = items_.begin(); half != items_.end();) {
        if (!are_halves(item.film, half->film)) {
            ++half;
            continue;
        }
        join(item, std::move(*half));
        items_.erase(half);
        half = items_.begin();  // the joined block may have its own other half
    }
    items_.push_back(std::move(item));
}

std::vector<HeldFilm::Item> HeldFilm::take_ready(const std::function<bool(const wire::FilmPart&)>& is_coming,
                                                 const std::function<Duration(ViewId)>& limit,
                                                 TimePoint now) {
    std::vector<Item> ready;
    std::erase_if(items_, [&](Item& item) {
        if (now - item.since < limit(item.film.view) && is_coming(item.film)) return false;
        ready.push_back(std::move(item));
        return true;
    });
    return ready;
}

std::optional<HeldFilm::Item> HeldFilm::take(UnitId unit) {
    const auto found = std::find_if(items_.begin(), items_.end(), [&](const Item& item) {
        return std::find(item.units.begin(), item.units.end(), unit) != item.units.end();
    });
    if (found == items_.end()) return std::nullopt;
    Item item = std::move(*found);
    items_.erase(found);
    return item;
}

std::vector<HeldFilm::Item> HeldFilm::take_view(ViewId view) {
    std::vector<Item> taken;
    std::erase_if(items_, [&](Item& item) {
        if (item.film.view != view) return false;
        taken.push_back(std::move(item));
        return true;
    });
    return taken;
}

std::vector<HeldFilm::Item> HeldFilm::take_all() {
    return std::exchange(items_, {});
}

std::size_t HeldFilm::unit_count() const {
    std::size_t count = 0;
    for (const Item& item : items_) count += item.units.size();
    return count;
}

std::optional<TimePoint> HeldFilm::next_event(const std::function<Duration(ViewId)>& limit) const {
    std::optional<TimePoint> first;
    for (const Item& item : items_) {
        const TimePoint due = item.since + limit(item.film.view);
        first = std::min(first.value_or(due), due);
    }
    return first;
}

}  // namespace tessera::node
