#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "master/render/reconstruction.h"
#include "mediator/frame/film_tile.h"
#include "mediator/picture/view_transform.h"
#include "mediator/view/view.h"
#include "mediator/wire/messages.h"

namespace tessera::master {

// The pictures of one output for one frame: its eyes, each of one or more layers.
struct OutputRequest {
    struct EyePicture {
        std::vector<view::View> layers;  // of whose films; back to front where depths are equal
        view::CameraPose in_display;     // sent with the picture
    };
    std::uint64_t frame = 0;
    std::size_t output = 0;
    SceneState scene;  // in the films
    std::vector<EyePicture> eyes;
    session::PictureEncoding encoding = session::PictureEncoding::Bytes;  // or Half
    picture::ViewTransform transform{view::ViewTransform::Linear, 0.0};   // the same for all outputs
    bool stereo_difference = false;  // of two eyes whose films have depth
};
struct OutputResult {
    OutputRequest request;
    struct Picture {
        std::uint32_t width = 0, height = 0;
        std::shared_ptr<const std::vector<std::byte>> bytes;  // empty when it failed
    };
    std::vector<Picture> eyes;
    std::uint64_t samples = 0;  // per pixel in the mean, of the film with the fewest
    double stereo_difference = 0.0;
    std::string error;
};

// Films in the order of the eyes and their layers; with several layers they must have depth. Each view is filtered
// separately: no data passes from one eye or output to another. Failures are reported in `error`.
OutputResult reconstruct_output(OutputRequest request, const std::vector<frame::FilmTile>& films,
                                Reconstructor& reconstructor);

}  // namespace tessera::master
