#pragma once

#include <immintrin.h>

#include <functional>
#include <vector>

#include "mediator/display/output_pipeline.h"

// Input pictures for an output's pipeline, and its output.
namespace tessera::display::test {

using Rgb = std::array<float, 3>;

class Picture {
  public:
    Picture(std::uint32_t width, std::uint32_t height,
            const std::function<Rgb(std::uint32_t, std::uint32_t)>& color)
        : width_(width), height_(height) {
        for (std::uint32_t y = 0; y < height; ++y)
            for (std::uint32_t x = 0; x < width; ++x)
                for (const float value : color(x, y)) {
                    halves_.push_back(_cvtss_sh(value, 0));
                    bytes_.push_back(static_cast<std::byte>(std::min(std::max(value, 0.0f), 255.0f)));
                }
    }
    Picture(std::uint32_t width, std::uint32_t height, Rgb color)
        : Picture(width, height, [&](auto, auto) { return color; }) {}

    EyePicture half() const {
        return {EyePicture::Encoding::LinearHalf, width_, height_, std::as_bytes(std::span(halves_))};
    }
    // The colours are 8-bit codes.
    EyePicture bytes() const { return {EyePicture::Encoding::SrgbBytes, width_, height_, bytes_}; }

  private:
    std::uint32_t width_, height_;
    std::vector<std::uint16_t> halves_;
    std::vector<std::byte> bytes_;
};

template <class Value>
struct PipelineOutput {
    std::vector<std::vector<Value>> pictures;
    OutputPipeline::Report report;
    std::array<Value, 3> at(std::uint32_t width, std::uint32_t x, std::uint32_t y,
                            std::size_t picture = 0) const {
        const Value* p = pictures[picture].data() + 3 * (std::size_t{y} * width + x);
        return {p[0], p[1], p[2]};
    }
};

template <class Value>
PipelineOutput<Value> show(OutputPipeline& pipeline, const std::vector<EyePicture>& eyes, int threads = 2) {
    PipelineOutput<Value> shown;
    shown.pictures.assign(pipeline.picture_count(), std::vector<Value>(pipeline.value_count()));
    std::vector<std::span<Value>> devices(shown.pictures.begin(), shown.pictures.end());
    tbb::task_arena arena(threads);
    shown.report = pipeline.run(arena, eyes, devices);
    return shown;
}

inline Grid put(scene::BlobStore& arrays, std::uint32_t columns, std::uint32_t rows, std::uint32_t components,
                Grid::Nodes nodes, const std::vector<float>& values) {
    return {columns, rows, components, nodes,
            scene::reference(*arrays.insert(std::as_bytes(std::span(values))))};
}

// A wall of 2 x 1 metres, two metres in front of the display's origin.
inline ProjectionPlane wall() {
    return {.origin = {0, 0, -2}, .hull = {{-1, -0.5, -2}, {1, -0.5, -2}, {1, 0.5, -2}, {-1, 0.5, -2}}};
}

}  // namespace tessera::display::test
