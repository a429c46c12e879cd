#include "mediator/display/output_pipeline.h"

#include <immintrin.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "mediator/base/error.h"
#include "mediator/base/parallel.h"
#include "mediator/display/frustum.h"
#include "mediator/display/turn.h"

namespace tessera::display {

namespace {

constexpr std::size_t RowsOfTask = 8;

bool mixes(Stereo stereo) {
    return stereo == Stereo::AnaglyphPlain || stereo == Stereo::AnaglyphDubois;
}

std::size_t bytes_per_value(EyePicture::Encoding encoding) {
    return encoding == EyePicture::Encoding::SrgbBytes ? 1 : 2;
}

void expect(bool is_so, const Output& output, const char* what) {
    if (!is_so) throw Error(ErrorCode::InvalidInput, "output '" + output.name + "': " + what);
}

void check(const EyePicture& picture, const Output& output) {
    expect(picture.width > 0 && picture.height > 0 && picture.width <= MaxEdge && picture.height <= MaxEdge,
           output, "an eye's picture is empty or too large");
    expect(picture.values.size() ==
               std::size_t{3} * picture.width * picture.height * bytes_per_value(picture.encoding),
           output, "the bytes of an eye's picture do not match its size");
    expect(reinterpret_cast<std::uintptr_t>(picture.values.data()) % bytes_per_value(picture.encoding) == 0,
           output, "the half floats of an eye's picture are not aligned");
}

std::array<std::uint16_t, 256> halves_of_srgb() {
    const DeviceColor srgb{Color{}};
    std::array<std::uint16_t, 256> halves{};
    for (std::size_t code = 0; code < halves.size(); ++code)
        halves[code] = static_cast<std::uint16_t>(
            _cvtss_sh(static_cast<float>(srgb.light(static_cast<double>(code) / 255.0)), 0));
    return halves;
}

// Clamps to [0, 1]; pixels that are not finite become black and are counted.
std::uint64_t keep_in_range(std::size_t count, PlanarRow row) {
    const __m256 zero = _mm256_setzero_ps(), one = _mm256_set1_ps(1.0f);
    std::uint64_t bad = 0;
    for (std::size_t i = 0; i < count; i += PackSize) {
        const __m256 r = _mm256_loadu_ps(row.planes[0] + i), g = _mm256_loadu_ps(row.planes[1] + i),
                     b = _mm256_loadu_ps(row.planes[2] + i);
        // 0 times a non-finite value is NaN. Sums of halves are finite floats.
        const __m256 zeros =
            _mm256_mul_ps(_mm256_add_ps(_mm256_add_ps(_mm256_mul_ps(r, zero), _mm256_mul_ps(g, zero)),
                                        _mm256_mul_ps(b, zero)),
                          zero);
        const __m256 is_fine = _mm256_cmp_ps(zeros, zeros, _CMP_ORD_Q);
        const std::size_t here = std::min(count - i, PackSize);
        const auto fine = static_cast<unsigned>(_mm256_movemask_ps(is_fine)) | ~((1u << here) - 1u);
        bad += static_cast<std::uint64_t>(std::popcount(~fine));
        for (const auto& [plane, value] :
             {std::pair(row.planes[0], r), {row.planes[1], g}, {row.planes[2], b}})
            _mm256_storeu_ps(plane + i,
                             _mm256_and_ps(_mm256_min_ps(_mm256_max_ps(value, zero), one), is_fine));
    }
    return bad;
}

}  // namespace

OutputPipeline::OutputPipeline(const Output& output, const scene::BlobStore& arrays)
    : output_(output), blend_(output, arrays), color_(output.color) {
    expect(output.width > 0 && output.height > 0 && output.width <= MaxEdge && output.height <= MaxEdge,
           output, "the device is empty or too large");
    expect(output.stereo != Stereo::SideBySide || output.width % 2 == 0, output,
           "eyes side by side need an even width");
    expect(output.stereo != Stereo::TopBottom || output.height % 2 == 0, output,
           "eyes above each other need an even height");
    if (!output.points.empty()) {
        expect(output.points.components == 3, output, "points have three components");
        points_ = DeviceGrid(output.points, output, arrays, "points");
    }
    for (const view::Eye eye : display::eyes(output.stereo)) {
        eyes_.push_back({.eye = eye});
        if (!points_.empty()) eyes_.back().warp = std::make_unique<Warp>(points_, output_);
    }
}

void OutputPipeline::set_frustum(view::Eye eye, const view::CameraPose& in_display) {
    for (Eye& each : eyes_)
        if (each.eye == eye && each.warp) each.warp->set_frustum(in_display);
}

bool OutputPipeline::passes_bytes(std::span<const EyePicture> pictures) const {
    if (takes_linear_light(output_) || output_.stereo == Stereo::SideBySide ||
        output_.stereo == Stereo::TopBottom)
        return false;
    const bool is_on_side = swaps_edges(output_.turn);
    return std::ranges::all_of(pictures, [&](const EyePicture& picture) {
        return picture.encoding == EyePicture::Encoding::SrgbBytes &&
               picture.width == (is_on_side ? output_.height : output_.width) &&
               picture.height == (is_on_side ? output_.width : output_.height);
    });
}

std::size_t OutputPipeline::eye_of_row(std::size_t picture, std::size_t y) const {
    if (output_.stereo == Stereo::Separate) return picture;
    if (output_.stereo != Stereo::InterlacedRows) return 0;
    return static_cast<std::size_t>((output_.y + static_cast<std::int64_t>(y)) & 1);
}

void OutputPipeline::copy_bytes(tbb::task_arena& arena, std::span<const EyePicture> pictures,
                                std::span<const std::span<std::uint8_t>> devices) const {
    const std::size_t width = output_.width, height = output_.height;
    for (std::size_t p = 0; p < devices.size(); ++p) {
        parallel_for(arena, (height + RowsOfTask - 1) / RowsOfTask, [&](std::size_t task) {
            const std::size_t end = std::min(height, (task + 1) * RowsOfTask);
            for (std::size_t y = task * RowsOfTask; y < end; ++y) {
                const EyePicture& picture = pictures[eye_of_row(p, y)];
                std::uint8_t* to = devices[p].data() + 3 * y * width;
                if (output_.turn == Turn::None) {
                    std::memcpy(to, picture.values.data() + 3 * y * width, 3 * width);
                    continue;
                }
                for (std::size_t x = 0; x < width; ++x) {
                    const PixelPosition from = upright_position(output_.turn, {x, y}, width, height);
                    std::memcpy(to + 3 * x, picture.values.data() + 3 * (from.y * picture.width + from.x), 3);
                }
            }
        });
    }
}

// Half floats are used in place. Bytes are converted to halves first, and a single column is duplicated.
void OutputPipeline::take(tbb::task_arena& arena, const EyePicture& picture, Eye& eye) const {
    const auto* halves = reinterpret_cast<const std::uint16_t*>(picture.values.data());
    eye.picture = {halves, picture.width, picture.height};
    const bool is_bytes = picture.encoding == EyePicture::Encoding::SrgbBytes;
    if (!is_bytes && picture.width > 1) return;
    const std::size_t width = std::max(picture.width, 2u);
    eye.as_half.resize(std::max(eye.as_half.size(), 3 * width * picture.height));
    static const std::array<std::uint16_t, 256> OfByte = halves_of_srgb();
    parallel_for(arena, picture.height, [&](std::size_t y) {
        std::uint16_t* to = eye.as_half.data() + 3 * width * y;
        const std::size_t from = std::size_t{3} * picture.width * y, count = std::size_t{3} * picture.width;
        for (std::size_t i = 0; i < count; ++i)
            to[i] =
                is_bytes ? OfByte[std::to_integer<std::size_t>(picture.values[from + i])] : halves[from + i];
        if (picture.width == 1) std::memcpy(to + 3, to, 3 * sizeof *to);
    });
    eye.picture = {eye.as_half.data(), static_cast<std::uint32_t>(width), picture.height};
}

// Samples the picture for the pixels of row y of the device.
void OutputPipeline::fetch(Eye& eye, std::size_t y, Space& space, PlanarRow out) const {
    const std::size_t width = output_.width, height = output_.height;
    if (eye.warp) {
        const Warp::Row row = eye.warp->row(y, space.points);
        return sample_row(eye.picture, row.u, row.v, width, out);
    }
    if (output_.turn == Turn::None && eye.picture.width == width && eye.picture.height == height)
        return copy_row(eye.picture, y, out);
    const bool is_on_side = swaps_edges(output_.turn);
    const float scale_x =
                    static_cast<float>(eye.picture.width) / static_cast<float>(is_on_side ? height : width),
                scale_y =
                    static_cast<float>(eye.picture.height) / static_cast<float>(is_on_side ? width : height);
    for (std::size_t x = 0; x < width; ++x) {
        const PixelPosition at = upright_position(output_.turn, {x, y}, width, height);
        space.x[x] = (static_cast<float>(at.x) + 0.5f) * scale_x - 0.5f;
        space.y[x] = (static_cast<float>(at.y) + 0.5f) * scale_y - 0.5f;
    }
    sample_row_at(eye.picture, space.x.data(), space.y.data(), width, out);
}

void OutputPipeline::shade(Eye& eye, std::size_t y, Space& space, PlanarRow out) const {
    fetch(eye, y, space, out);
    space.not_finite += keep_in_range(output_.width, out);
    blend_.apply(y, out);
}

// Row y of a device's picture, in linear light.
PlanarRow OutputPipeline::compose(std::size_t picture, std::size_t y, Space& space) {
    const std::size_t width = output_.width, height = output_.height;
    const PlanarRow out = space.rows.row(0), other = space.rows.row(1);
    if (output_.stereo == Stereo::SideBySide) {
        for (std::size_t eye = 0; eye < 2; ++eye) {
            shade(eyes_[eye], y, space, other);
            halve_columns(other, width / 2, eye * (width / 2), out);
        }
    } else if (output_.stereo == Stereo::TopBottom) {
        Eye& eye = eyes_[y < height / 2 ? 0 : 1];
        const std::size_t first = 2 * (y % (height / 2));
        shade(eye, first, space, other);
        shade(eye, first + 1, space, out);
        average_rows(width, other, out);
    } else if (mixes(output_.stereo)) {
        shade(eyes_[0], y, space, other);
        shade(eyes_[1], y, space, out);
        mix_eyes(eye_mix(output_.stereo), width, other, out);
    } else {
        shade(eyes_[eye_of_row(picture, y)], y, space, out);
    }
    color_.apply_matrix(width, out);
    return out;
}

template <class Value>
void OutputPipeline::check_all(std::span<const EyePicture> pictures,
                               std::span<const std::span<Value>> devices) const {
    expect(pictures.size() == eye_count(), output_, "a frame has pictures of a different number of eyes");
    expect(devices.size() == picture_count(), output_, "the number of device pictures is wrong");
    for (const EyePicture& picture : pictures) check(picture, output_);
    for (const std::span<Value>& device : devices)
        expect(device.size() == value_count(), output_, "the size of a device picture is wrong");
}

template <class Value>
OutputPipeline::Report OutputPipeline::run_all(tbb::task_arena& arena, std::span<const EyePicture> pictures,
                                               std::span<const std::span<Value>> devices) {
    const std::size_t width = output_.width, height = output_.height;
    for (std::size_t eye = 0; eye < eyes_.size(); ++eye) take(arena, pictures[eye], eyes_[eye]);
    while (spaces_.size() < static_cast<std::size_t>(arena.max_concurrency()))
        spaces_.push_back({.rows = RowSpace(width, 2),
                           .x = std::vector<float>(padded(width)),
                           .y = std::vector<float>(padded(width)),
                           .points = std::vector<float>(Warp::space_for(width, points_)),
                           .bytes = std::vector<std::uint8_t>(3 * padded(width) + 8)});
    for (Space& space : spaces_) space.not_finite = 0;
    for (std::size_t p = 0; p < devices.size(); ++p) {
        parallel_for(arena, (height + RowsOfTask - 1) / RowsOfTask, [&](std::size_t task) {
            Space& space = spaces_[static_cast<std::size_t>(tbb::this_task_arena::current_thread_index())];
            const std::size_t end = std::min(height, (task + 1) * RowsOfTask);
            for (std::size_t y = task * RowsOfTask; y < end; ++y) {
                const PlanarRow row = compose(p, y, space);
                Value* to = devices[p].data() + 3 * y * width;
                if constexpr (std::is_same_v<Value, std::uint8_t>)
                    color_.encode(width, y, row, space.bytes.data(), to);
                else
                    color_.encode(width, row, to);
            }
        });
    }
    Report report;
    for (const Space& space : spaces_) report.not_finite += space.not_finite;
    return report;
}

OutputPipeline::Report OutputPipeline::run(tbb::task_arena& arena, std::span<const EyePicture> pictures,
                                           std::span<const std::span<std::uint8_t>> devices) {
    check_all(pictures, devices);
    if (!passes_bytes(pictures)) return run_all(arena, pictures, devices);
    copy_bytes(arena, pictures, devices);
    return {};
}

OutputPipeline::Report OutputPipeline::run(tbb::task_arena& arena, std::span<const EyePicture> pictures,
                                           std::span<const std::span<float>> devices) {
    check_all(pictures, devices);
    return run_all(arena, pictures, devices);
}

}  // namespace tessera::display
