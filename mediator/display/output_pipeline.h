#pragma once

#include <tbb/task_arena.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "mediator/display/blend.h"
#include "mediator/display/device_color.h"
#include "mediator/display/picture_sampler.h"
#include "mediator/display/stereo_packing.h"
#include "mediator/display/warp.h"

namespace tessera::display {

// One eye's picture, red, green and blue of each pixel, rows from the top. Coarse passes are smaller than the
// output's view.
struct EyePicture {
    enum class Encoding : std::uint8_t { SrgbBytes, LinearHalf };
    Encoding encoding = Encoding::LinearHalf;
    std::uint32_t width = 0, height = 0;
    std::span<const std::byte> values;
};

// From the pictures of an output's eyes to its device values: warp, soft edges and black level, both eyes
// packed into one picture, colours of the device. Light is clamped to full white first, so that two
// overlapping projectors show no more than one. Bytes that need no processing are copied.
class OutputPipeline {
  public:
    // Reads the arrays of the output. Throws Error{NotFound} when one is not in the store, Error{InvalidInput} when one
    // does not have the output's size, or when an odd number of pixels is to be halved.
    OutputPipeline(const Output& output, const scene::BlobStore& arrays);
    OutputPipeline(const OutputPipeline&) = delete;
    OutputPipeline& operator=(const OutputPipeline&) = delete;

    // The frustum from which this eye sees the screen. Required before the first run when the output has points. With a
    // zero parallax distance d that differs from the screen's distance D from the head, use the frustum of the real
    // screen (screen_pose()): frustum(plane, head, eye, separation x D / d, 0), with the edges of the picture.
    void set_frustum(view::Eye eye, const view::CameraPose& in_display);

    std::size_t eye_count() const { return eyes_.size(); }
    std::size_t picture_count() const { return output_.stereo == Stereo::Separate ? 2 : 1; }
    std::size_t value_count() const {
        return std::size_t{3} * output_.width * output_.height;
    }  // of a picture

    struct Report {
        std::uint64_t not_finite = 0;  // pixels of eyes that were replaced by black
    };
    // `pictures`: one per eye, left first; `devices`: picture_count() times value_count() values, rgb, rows
    // from the top: bytes, or device values in [0, 1] that are not rounded. Allocates in the first run only,
    // and when a picture in bytes is larger than those before. Throws Error{InvalidInput} when a picture does not
    // have its stated size.
    Report run(tbb::task_arena& arena, std::span<const EyePicture> pictures,
               std::span<const std::span<std::uint8_t>> devices);
    Report run(tbb::task_arena& arena, std::span<const EyePicture> pictures,
               std::span<const std::span<float>> devices);

  private:
    struct Eye {
        view::Eye eye;
        std::unique_ptr<Warp> warp;          // when the output has points
        std::vector<std::uint16_t> as_half;  // of a picture in bytes
        HalfPicture picture;
    };
    // Scratch memory of one thread.
    struct Space {
        RowSpace rows;
        std::vector<float> x, y, points;
        std::vector<std::uint8_t> bytes;
        std::uint64_t not_finite = 0;
    };

    template <class Value>
    void check_all(std::span<const EyePicture> pictures, std::span<const std::span<Value>> devices) const;
    template <class Value>
    Report run_all(tbb::task_arena& arena, std::span<const EyePicture> pictures,
                   std::span<const std::span<Value>> devices);
    bool passes_bytes(std::span<const EyePicture> pictures) const;
    void copy_bytes(tbb::task_arena& arena, std::span<const EyePicture> pictures,
                    std::span<const std::span<std::uint8_t>> devices) const;
    void take(tbb::task_arena& arena, const EyePicture& picture, Eye& eye) const;
    std::size_t eye_of_row(std::size_t picture, std::size_t y) const;
    void fetch(Eye& eye, std::size_t y, Space& space, PlanarRow out) const;
    void shade(Eye& eye, std::size_t y, Space& space, PlanarRow out) const;
    PlanarRow compose(std::size_t picture, std::size_t y, Space& space);

    Output output_;
    DeviceGrid points_;
    BlendMap blend_;
    DeviceColor color_;
    std::vector<Eye> eyes_;
    std::vector<Space> spaces_;  // one a thread
};

}  // namespace tessera::display
