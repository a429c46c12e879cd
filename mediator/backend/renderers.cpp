#include "mediator/backend/backend.h"

namespace tessera::backend {

Expected<void> EditScope::apply(const scene::ChangeList& changes) {
    const Expected<scene::Scene> after = scene::after(scene(), changes);
    return after ? apply(changes, *after) : tl::unexpected(after.error());
}

void require_renderer(view::RendererSet available, const view::View& view) {
    if (available.contains(view.renderer)) return;
    const std::string name(view::renderer_name(view.renderer));
    const bool is_raster = view.renderer == view::Renderer::Raster;
    throw Error(ErrorCode::Refused,
                "this back-end has no renderer " + name +
                    (is_raster ? ": start with --backend vulkan, on a device with graphics"
                               : ": choose another one"));
}

}  // namespace tessera::backend
