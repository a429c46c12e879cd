#pragma once

#include <cstddef>
#include <iterator>
#include <memory>
#include <utility>
#include <vector>

#include "mediator/base/copy_on_write.h"
#include "mediator/scene/objects.h"

namespace tessera::scene {

// Objects by id, in id order. Copies are cheap: they share all objects and, copy on write, the pages of the map.
// Iterators are valid until their map changes.
class ObjectMap {
  public:
    using value_type = std::pair<ObjectId, std::shared_ptr<const Object>>;

  private:
    using Page = std::vector<value_type>;
    using Pages = std::vector<CopyOnWrite<Page>>;  // ascending, none empty

  public:
    class const_iterator {
      public:
        using value_type = ObjectMap::value_type;
        using reference = const value_type&;
        using pointer = const value_type*;
        using difference_type = std::ptrdiff_t;
        using iterator_category = std::bidirectional_iterator_tag;

        const_iterator() = default;
        reference operator*() const { return (*(*pages_)[page_])[slot_]; }
        pointer operator->() const { return &**this; }
        const_iterator& operator++() {
            if (++slot_ == (*pages_)[page_]->size()) {
                ++page_;
                slot_ = 0;
            }
            return *this;
        }
        const_iterator operator++(int) { return std::exchange(*this, std::next(*this)); }
        const_iterator& operator--() {
            if (slot_ == 0) slot_ = (*pages_)[--page_]->size();
            --slot_;
            return *this;
        }
        const_iterator operator--(int) { return std::exchange(*this, std::prev(*this)); }
        friend bool operator==(const const_iterator&, const const_iterator&) = default;

      private:
        friend class ObjectMap;
        const_iterator(const Pages* pages, std::size_t page, std::size_t slot)
            : pages_(pages), page_(page), slot_(slot) {}

        const Pages* pages_ = nullptr;
        std::size_t page_ = 0, slot_ = 0;
    };

    const_iterator begin() const { return {&*pages_, 0, 0}; }
    const_iterator end() const { return {&*pages_, pages_->size(), 0}; }
    auto rbegin() const { return std::make_reverse_iterator(end()); }
    std::size_t size() const { return size_; }
    const_iterator lower_bound(ObjectId id) const;
    const_iterator find(ObjectId id) const;

    void set(ObjectId id, std::shared_ptr<const Object> object);  // inserts or replaces
    void erase(ObjectId id);                                      // if present

  private:
    std::size_t page_of(ObjectId id) const;  // of an existing or a new id; 0 in an empty map

    CopyOnWrite<Pages> pages_;
    std::size_t size_ = 0;
};

}  // namespace tessera::scene
