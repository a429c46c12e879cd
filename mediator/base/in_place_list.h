#pragma once

#include <array>
#include <cassert>
#include <cstddef>

namespace tessera {

// A list of at most `Capacity` small values, stored inline.
template <class T, std::size_t Capacity>
class InPlaceList {
  public:
    void push_back(const T& item) {
        assert(size_ < Capacity);
        if (size_ < Capacity) items_[size_++] = item;
    }
    std::size_t size() const { return size_; }
    bool empty() const { return size_ == 0; }
    const T& operator[](std::size_t i) const { return items_[i]; }
    const T* begin() const { return items_.data(); }
    const T* end() const { return items_.data() + size_; }

  private:
    std::array<T, Capacity> items_{};
    std::size_t size_ = 0;
};

}  // namespace tessera
