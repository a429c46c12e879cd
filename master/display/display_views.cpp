// The views that nodes render for a display, and the requests for pictures of its outputs.
#include "master/display/display_service.h"
#include "mediator/display/frustum.h"

namespace tessera::master {

namespace {

std::size_t layer_count(const display::Display& display) {
    return std::max<std::size_t>(1, display.layers.size());
}

bool is_shown(const display::Display& display, std::size_t layer) {
    return display.layers.empty() || display.layers[layer].shown;
}

}  // namespace

std::vector<GroupView> DisplayService::views() {
    const display::Display& display = open_->display;
    const auto& carrier = open_->camera.world_from_camera();
    std::vector<GroupView> wanted;
    open_->plan.assign(display.outputs.size(), {});
    if (!carrier) return wanted;
    for (std::size_t i = 0; i < display.outputs.size(); ++i) {
        const display::Output& output = display.outputs[i];
        const auto eyes = display::eyes(output.stereo);
        for (const view::Eye eye : eyes) {
            const view::CameraPose pose = display::frustum(output.plane, display.head, eye,
                                                           display.eye_separation, display.zero_parallax);
            PlannedEye& planned = open_->plan[i].emplace_back();
            planned.in_display = display::screen_pose(output.plane, display.head, eye, display.eye_separation,
                                                      display.zero_parallax);
            for (std::size_t layer = 0; layer < layer_count(display); ++layer) {
                if (!is_shown(display, layer)) continue;
                GroupView view{.name = "display/" + output.name, .view = {}, .priority = output.priority};
                if (eye != view::Eye::Mono) view.name += eye == view::Eye::Left ? "/left" : "/right";
                if (!display.layers.empty()) view.name += "/" + display.layers[layer].name;
                view.view.camera = display::in_world(pose, *carrier, display.units_per_metre);
                view.view.eye = eye;
                view.view.width = output.view_width;
                view.view.height = output.view_height;
                view.view.window = {0, 0, static_cast<std::int32_t>(output.view_width),
                                    static_cast<std::int32_t>(output.view_height)};
                view.view.max_bounces = display.max_bounces;
                view.view.sky_cells_from = view::visible_sky_from(view.view.window);
                view.view.filter = display.filter;
                view.view.channels = {frame::Channel::Color};
                if (!display.layers.empty()) {
                    view.view.renderer = display.layers[layer].renderer;
                    view.view.layers = display.layers[layer].layers;
                }
                view.view.transparent_background = layer_count(display) > 1;
                if (layer_count(display) > 1 || (display.stereo_difference && eyes.size() == 2))
                    view.view.channels.insert(frame::Channel::Depth);
                complete(view.view);
                if (has_noise(view.view) && display.spp > session::StopRule::AdaptiveBase)
                    view.view.channels.insert(frame::Channel::BlockVariance);
                wanted.push_back(std::move(view));
                ++planned.layers;
            }
        }
    }
    return wanted;
}

// Two frames are in progress or waiting, so that nodes need not wait for either; a third would only add latency.
bool DisplayService::can_take() const {
    return open_->in_progress.size() + (open_->waiting ? 1 : 0) < 2;
}

// Uses the plan of the request for this stage: the display may have been adjusted since.
void DisplayService::take(const GroupStage& stage) {
    const display::Display& display = open_->display;
    Frame& frame =
        open_->in_progress.emplace_back(Frame{.number = next_frame_++, .version = stage.scene.version});
    frame.missing = display.outputs.size();
    frame.outputs.resize(display.outputs.size());
    auto view = stage.views.begin();
    for (std::size_t i = 0; i < display.outputs.size(); ++i) {
        const std::vector<PlannedEye>& eyes = open_->plan.at(i);
        OutputRequest request{.frame = frame.number, .output = i, .scene = stage.scene, .eyes = {}};
        request.encoding = display::takes_linear_light(display.outputs[i]) ? session::PictureEncoding::Half
                                                                           : session::PictureEncoding::Bytes;
        request.transform = {display.view_transform, display.exposure, display.white};
        request.stereo_difference = display.stereo_difference && eyes.size() == 2 && stage.scale == 1;
        for (const PlannedEye& eye : eyes) {
            const auto end = view + static_cast<std::ptrdiff_t>(eye.layers);
            request.eyes.push_back({.layers = {view, end}, .in_display = eye.in_display});
            view = end;
        }
        renderer_.reconstruct_output(std::move(request));
    }
}

}  // namespace tessera::master
