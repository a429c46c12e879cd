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

// From the pictures of an output's eyes to what its device shows: warp, soft edges and black level, both eyes
// packed into one picture, colours of the device. Light is cut off at full white first, so that two
// projectors that overlap show no more than one. Bytes that need nothing of this pass as they are.
class OutputPipeline {
  public:
    // The arrays of the output are read here, once. Throws Error{NotFound} when one is not in the store and
    // Error{InvalidInput} when one has another size than the output says, or when halves of an odd number of
    // pixels are asked for.
    OutputPipeline(const Output& output, const scene::BlobStore& arrays);
    OutputPipeline(const OutputPipeline&) = delete;
    OutputPipeline& operator=(const OutputPipeline&) = delete;

    // Where this eye sees the screen from. Needed before the first run when the output has points. With a
    // zero parallax d off the screen, which is thought D from the head, the camera's eye is the one that sees
    // the screen itself as the picture shows it: frustum(plane, head, eye, separation x D / d, 0), with the
    // same edges as the picture's.
    void set_frustum(view::Eye eye, const view::CameraPose& in_display);

    std::size_t eye_count() const { return eyes_.size(); }
    std::size_t picture_count() const { return output_.stereo == Stereo::Separate ? 2 : 1; }
    std::size_t value_count() const {
        return std::size_t{3} * output_.width * output_.height;
    }  // of a picture

    struct Report {
        std::uint64_t not_finite = 0;  // pixels of eyes that were shown black
    };
    // `pictures`: one an eye, left first; `devices`: picture_count() times value_count() values, rgb, rows
    // from the top: bytes, or device values in [0, 1] that are not rounded. Allocates in the first run alone,
    // and when a picture in bytes is larger than those before. Throws Error{InvalidInput} when a picture has
    // not the size that it says.
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
    // What one thread works in.
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
