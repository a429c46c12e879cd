// What the nodes render for a display, and the pictures that are made of it.
#include "master/display/display_service.h"
#include "master/job.h"
#include "mediator/display/frustum.h"
#include "mediator/view/placed_cameras.h"

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
    std::vector<GroupView> wanted;
    open_->poses.clear();
    if (!view::choose_camera(authority_.scene(), display.camera)) return wanted;
    for (const display::Output& output : display.outputs) {
        for (const view::Eye eye : display::eyes(output.stereo)) {
            const view::CameraPose pose = display::frustum(output.plane, display.head, eye,
                                                           display.eye_separation, display.zero_parallax);
            const view::CameraPose seen_from = display::screen_pose(
                output.plane, display.head, eye, display.eye_separation, display.zero_parallax);
            for (std::size_t layer = 0; layer < layer_count(display); ++layer) {
                if (!is_shown(display, layer)) continue;
                GroupView view{.name = "display/" + output.name, .view = {}, .priority = output.priority};
                if (eye != view::Eye::Mono) view.name += eye == view::Eye::Left ? "/left" : "/right";
                if (!display.layers.empty()) view.name += "/" + display.layers[layer].name;
                view.view.camera =
                    display::in_world(pose, open_->world_from_display, display.units_per_metre);
                view.view.eye = eye;
                view.view.width = output.view_width;
                view.view.height = output.view_height;
                view.view.window = {0, 0, static_cast<std::int32_t>(output.view_width),
                                    static_cast<std::int32_t>(output.view_height)};
                view.view.max_bounces = display.max_bounces;
                view.view.filter = display.filter;
                if (!display.layers.empty()) {
                    view.view.renderer = display.layers[layer].renderer;
                    view.view.layers = display.layers[layer].layers;
                }
                if (layer_count(display) > 1) {
                    view.view.transparent_background = true;
                    view.view.channels.insert(frame::Channel::Depth);
                }
                view.view.channels = {frame::Channel::Color};
                if (display.stereo_difference && eye != view::Eye::Mono)
                    view.view.channels.insert(frame::Channel::Depth);
                complete(view.view);
                wanted.push_back(std::move(view));
                open_->poses.push_back(seen_from);
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

void DisplayService::take(const GroupStage& stage, TimePoint) {
    const display::Display& display = open_->display;
    Frame& frame = open_->making.emplace_back(Frame{.number = next_frame_++, .version = stage.version});
    frame.missing = display.outputs.size();
    frame.outputs.resize(display.outputs.size());
    std::size_t view = 0;
    for (std::size_t i = 0; i < display.outputs.size(); ++i) {
        const display::Output& output = display.outputs[i];
        OutputOrder order{.frame = frame.number, .output = i, .eyes = {}};
        order.encoding =
            display::takes_linear_light(output) ? wire::PictureEncoding::Half : wire::PictureEncoding::Bytes;
        order.look = {display.exposure, display.white};
        order.stereo_difference = display.stereo_difference && stage.scale == 1;
        for (std::size_t eye = 0; eye < display::eyes(output.stereo).size(); ++eye) {
            OutputOrder::EyePicture picture{.layers = {}, .in_display = open_->poses.at(view)};
            for (std::size_t layer = 0; layer < layer_count(display); ++layer) {
                if (is_shown(display, layer)) picture.layers.push_back(stage.views.at(view++));
            }
            order.eyes.push_back(std::move(picture));
        }
        runner_.make_output(std::move(order));
    }
}

}  // namespace tessera::master
