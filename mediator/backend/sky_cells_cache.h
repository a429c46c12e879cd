#pragma once

#include <algorithm>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>

#include "mediator/base/ids.h"
#include "mediator/view/view.h"

namespace tessera::backend {

// The sky cells of the views that a back-end renders, in the form that it needs, made when a sample first needs them.
// Thread-safe.
template <class Cells>
class SkyCellsCache {
  public:
    static constexpr std::size_t MaxViews = 16;
    using Make = std::function<std::shared_ptr<const Cells>()>;

    // nullptr: `make` was stopped. Other threads wait while cells are made.
    std::shared_ptr<const Cells> find(const Version& version, const view::View& view, const Make& make) {
        const std::scoped_lock lock(mutex_);
        if (version != version_) entries_.clear();
        version_ = version;
        const auto known = std::find_if(entries_.begin(), entries_.end(),
                                        [&](const Entry& entry) { return entry.view == view; });
        if (known != entries_.end()) {
            std::rotate(known, known + 1, entries_.end());
            return entries_.back().cells;
        }
        std::shared_ptr<const Cells> made = make();
        if (made == nullptr) return nullptr;
        if (entries_.size() == MaxViews) entries_.pop_front();
        return entries_.emplace_back(view, std::move(made)).cells;
    }
    void clear() {
        const std::scoped_lock lock(mutex_);
        entries_.clear();
    }

  private:
    struct Entry {
        view::View view;
        std::shared_ptr<const Cells> cells;
    };
    std::mutex mutex_;
    Version version_;
    std::deque<Entry> entries_;  // those used last at the back
};

}  // namespace tessera::backend
