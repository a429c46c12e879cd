#include "client/tools/frame_picture.h"

#include <algorithm>
#include <cstring>
#include <optional>
#include <utility>

#include "mediator/base/error.h"
#include "mediator/picture/film_exr.h"

namespace tessera::tools {

frame::Image picture_of(const client::Frame& frame, std::uint32_t width, std::uint32_t height) {
    frame::Image image(width, height, 3);
    const std::size_t pixels = std::size_t{frame.width} * frame.height;
    if (frame.components < 3 || frame.picture.size() != pixels * frame.components * sizeof(float))
        throw Error(
            ErrorCode::InvalidInput,
            "the master sent a picture whose size does not match its header: check that master and client "
            "are of the same version");
    std::vector<float> values(pixels * frame.components);
    std::memcpy(values.data(), frame.picture.data(), frame.picture.size());
    for (std::uint32_t y = 0; y < height; ++y) {
        const std::size_t row = std::size_t{std::min(y / frame.scale, frame.height - 1)} * frame.width;
        for (std::uint32_t x = 0; x < width; ++x) {
            const std::size_t from = row + std::min(x / frame.scale, frame.width - 1);
            for (std::size_t c = 0; c < 3; ++c)
                image.values[3 * (std::size_t{y} * width + x) + c] = values[c * pixels + from];
        }
    }
    return image;
}

std::vector<picture::Layer> layers_of(const client::Frame& frame, const frame::Image& picture,
                                      Samples samples) {
    if (!frame.film) return {{"", {"R", "G", "B"}, picture}};
    std::optional<frame::Image> denoised;
    if (samples == Samples::AreDenoised) denoised = picture;
    std::vector<picture::Layer> layers = picture::film_layers(*frame.film, denoised);
    for (picture::Layer& layer : layers) {
        const frame::Image& from = layer.image;
        if (from.width == picture.width && from.height == picture.height) continue;
        frame::Image to(picture.width, picture.height, from.components);
        for (std::size_t y = 0; y < to.height; ++y) {
            for (std::size_t x = 0; x < to.width; ++x) {
                const std::size_t row = y * from.height / to.height, column = x * from.width / to.width;
                std::ranges::copy(from.pixel(row * from.width + column), to.pixel(y * to.width + x).begin());
            }
        }
        layer.image = std::move(to);
    }
    return layers;
}

}  // namespace tessera::tools
