#include "mediator/scene/object_map.h"

#include <algorithm>

namespace tessera::scene {

namespace {

constexpr std::size_t PageLimit = 128;  // objects; the first change of a page after a copy copies that many

constexpr auto by_id = [](const ObjectMap::value_type& item, ObjectId id) { return item.first < id; };

}  // namespace

std::size_t ObjectMap::page_of(ObjectId id) const {
    const auto after = std::upper_bound(
        pages_->begin(), pages_->end(), id,
        [](ObjectId wanted, const CopyOnWrite<Page>& page) { return wanted < page->front().first; });
    return after == pages_->begin() ? 0 : static_cast<std::size_t>(after - pages_->begin()) - 1;
}

ObjectMap::const_iterator ObjectMap::lower_bound(ObjectId id) const {
    if (size_ == 0) return end();
    const std::size_t at = page_of(id);
    const Page& page = *(*pages_)[at];
    const auto slot = std::lower_bound(page.begin(), page.end(), id, by_id);
    if (slot == page.end()) return {&*pages_, at + 1, 0};
    return {&*pages_, at, static_cast<std::size_t>(slot - page.begin())};
}

ObjectMap::const_iterator ObjectMap::find(ObjectId id) const {
    const const_iterator place = lower_bound(id);
    return place != end() && place->first == id ? place : end();
}

void ObjectMap::set(ObjectId id, std::shared_ptr<const Object> object) {
    Pages& pages = pages_.edit();
    if (pages.empty()) pages.emplace_back();
    std::size_t at = size_ == 0 ? 0 : page_of(id);
    Page& page = pages[at].edit();
    auto slot = std::lower_bound(page.begin(), page.end(), id, by_id);
    if (slot != page.end() && slot->first == id) {
        slot->second = std::move(object);
        return;
    }
    ++size_;
    if (page.size() < PageLimit) {
        page.emplace(slot, id, std::move(object));
        return;
    }
    // The page is full. Appending, as most scenes grow, leaves full pages behind.
    const bool at_end = slot == page.end() && at + 1 == pages.size();
    const auto split = page.begin() + (at_end ? PageLimit : PageLimit / 2);
    Page upper(std::make_move_iterator(split), std::make_move_iterator(page.end()));
    page.erase(split, page.end());
    Page& half = upper.empty() || id > upper.front().first ? upper : page;
    half.emplace(std::lower_bound(half.begin(), half.end(), id, by_id), id, std::move(object));
    pages.emplace(pages.begin() + static_cast<std::ptrdiff_t>(at + 1), std::move(upper));
}

void ObjectMap::erase(ObjectId id) {
    if (find(id) == end()) return;
    Pages& pages = pages_.edit();
    const std::size_t at = page_of(id);
    Page& page = pages[at].edit();
    page.erase(std::lower_bound(page.begin(), page.end(), id, by_id));
    if (page.empty()) pages.erase(pages.begin() + static_cast<std::ptrdiff_t>(at));
    --size_;
}

}  // namespace tessera::scene
