// What the nodes render for a display, and the pictures that are made of it.
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
                wanted.push_back(std::move(view));
                ++planned.layers;
            }
        }
    }
    return wanted;
}

// One is made while another waits or is made, so that nodes need not wait for either; a third would only be
// older by the time that it is shown.
bool DisplayService::can_take() const {
    return open_->making.size() + (open_->waiting ? 1 : 0) < 2;
}

// By the plan that the stage's views were asked for: the display may have been adjusted since.
void DisplayService::take(const GroupStage& stage) {
    const display::Display& display = open_->display;
    Frame& frame = open_->making.emplace_back(Frame{.number = next_frame_++, .version = stage.version});
    frame.missing = display.outputs.size();
    frame.outputs.resize(display.outputs.size());
    auto view = stage.views.begin();
    for (std::size_t i = 0; i < display.outputs.size(); ++i) {
        const std::vector<PlannedEye>& eyes = open_->plan.at(i);
        OutputOrder order{.frame = frame.number, .output = i, .version = stage.version, .eyes = {}};
        order.encoding = display::takes_linear_light(display.outputs[i]) ? session::PictureEncoding::Half
                                                                         : session::PictureEncoding::Bytes;
        order.transform = {display.view_transform, display.exposure, display.white};
        order.stereo_difference = display.stereo_difference && eyes.size() == 2 && stage.scale == 1;
        for (const PlannedEye& eye : eyes) {
            const auto end = view + static_cast<std::ptrdiff_t>(eye.layers);
            order.eyes.push_back({.layers = {view, end}, .in_display = eye.in_display});
            view = end;
        }
        renderer_.make_output(std::move(order));
    }
}

}  // namespace tessera::master
