#pragma once

#include <map>

#include "master/render/scene_state.h"
#include "master/render/view_state.h"

namespace tessera::master {

// Statistics of the scene, as last reported by nodes.
struct SceneFacts {
    std::uint64_t triangles = 0, instances = 0, lights = 0;
};

// Allocates ids for the views of all scenes: unique among all passes.
class ViewIds {
  public:
    ViewId take() {  // and reserves MaxPasses ids
        const ViewId id{next_};
        next_ += MaxPasses;
        return id;
    }
    std::uint64_t given() const { return next_; }

  private:
    std::uint64_t next_ = 1;
};

// The views of a scene by their ids.
class ViewTable {
  public:
    explicit ViewTable(ViewIds& ids) : ids_(ids) {}

    ViewState& add() {
        const ViewId id = ids_.take();
        ViewState& view = views_[id];
        view.id = id;
        return view;
    }
    ViewIds& ids() { return ids_; }
    void erase(ViewId view) { views_.erase(view); }

    ViewState* find(ViewId view) {
        const auto found = views_.find(view);
        return found == views_.end() ? nullptr : &found->second;
    }
    const ViewState* find(ViewId view) const {
        const auto found = views_.find(view);
        return found == views_.end() ? nullptr : &found->second;
    }
    ViewState* named(const std::string& name);
    // The view that owns this pass.
    ViewState* of_pass(ViewId pass);
    std::map<ViewId, ViewState>& all() { return views_; }
    const std::map<ViewId, ViewState>& all() const { return views_; }

    SceneFacts facts;
    LastEdits last_edits;
    session::WireBytes
        bytes_at_start;  // of the master, before the scene was opened: baseline of the views' traffic
    // Changes wait to be published: no pass begins until then.
    bool passes_paused = false;

  private:
    ViewIds& ids_;
    std::map<ViewId, ViewState> views_;
};

}  // namespace tessera::master
