#include "master/render/view_table.h"

#include <algorithm>

namespace tessera::master {

ViewState* ViewTable::named(const std::string& name) {
    const auto found = std::find_if(views_.begin(), views_.end(),
                                    [&](const auto& entry) { return entry.second.name == name; });
    return found == views_.end() ? nullptr : &found->second;
}

ViewState* ViewTable::of_pass(ViewId pass) {
    const auto after = views_.upper_bound(pass);
    if (after == views_.begin()) return nullptr;
    ViewState& view = std::prev(after)->second;
    return pass.value - view.id.value < view.passes.size() ? &view : nullptr;
}

}  // namespace tessera::master
