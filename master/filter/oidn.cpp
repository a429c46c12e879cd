#include "master/filter/oidn.h"

#include <algorithm>
#include <cmath>

#include "master/filter/convergence_blend.h"
#include "master/filter/kernels.h"
#include "master/filter/oidn/library.h"
#include "master/filter/svgf/hole_fill.h"

namespace tessera::filter {

namespace {

using frame::Channel;

enum Parameters : std::size_t { UseConvergenceBlend };

// Any mean of equal values is that value, so alpha is left alone where it is constant this far around a pixel. The
// network would not quite keep it, and a surface would become slightly transparent.
constexpr std::uint32_t ConstantRadius = 2;

constexpr float BrightestColor = 1e30f;  // sums of so large values stay finite

// The planes that are read, without holes: colour, albedo, normal, alpha.
enum Plane : std::uint32_t { Color = 0, Albedo = 3, Normal = 6, Alpha = 9, PlaneCount = 10 };

class Oidn final : public Filter {
  public:
    Report run(const Inputs& inputs, const Values& values, Output& out, RunContext context) override {
        Report report;
        shape(out.picture, inputs, inputs.color_components());
        report.stopped = !reconstruct(inputs, values, out, report, context);
        return report;
    }

  private:
    bool reconstruct(const Inputs& inputs, const Values& values, Output& out, Report& report,
                     RunContext& context) {
        if (context.stop.stop_requested()) return false;
        const double image_bytes = 4.0 * 3;
        {
            PassTimer timer(report, "images", 2 * 3 * image_bytes);
            prepare(inputs, context);
            if (!read(inputs, context) || !store_images(context)) return false;
        }
        {
            PassTimer timer(report, "network", 4 * image_bytes);
            if (!network_->execute(context.stop) || !take_color(inputs, out.picture, context)) return false;
        }
        if (inputs.has(Channel::Alpha)) {
            PassTimer timer(report, "alpha", 4 * image_bytes);
            if (!filter_alpha(inputs, out.picture, context)) return false;
        }
        if (values[UseConvergenceBlend] == 0.0) return true;
        PassTimer timer(report, "convergence blend",
                        ConvergenceBlend::bytes_per_pixel(out.picture.components()));
        if (!convergence_blend_.apply(inputs, Channel::Radiance, {}, out.picture, context)) return false;
        if (out.wants_maps) out.maps = {{"blend", convergence_blend_.weights()}};
        return true;
    }

    // The library's objects, for this size. What could not be made is tried again.
    void prepare(const Inputs& inputs, RunContext& context) {
        if (network_ && width_ == inputs.width && height_ == inputs.height) return;
        network_.reset();
        width_ = inputs.width;
        height_ = inputs.height;
        for (std::vector<float>* image : {&color_, &albedo_, &normal_, &output_})
            image->resize(3 * inputs.pixel_count());
        auto network =
            std::make_unique<oidn::RayTracingFilter>(oidn::shared_device(context.arena.max_concurrency()));
        network->set({color_, albedo_, normal_, output_}, width_, height_);
        network_ = std::move(network);
    }

    // Copies of the means, holes filled from around them.
    bool read(const Inputs& inputs, RunContext& context) {
        shape(planes_, inputs, PlaneCount);
        for (std::uint32_t c = 0; c < 3; ++c) {
            std::ranges::copy(inputs.color(c), planes_.plane(Color + c).begin());
            std::ranges::copy(inputs.mean(Channel::Albedo).plane(c), planes_.plane(Albedo + c).begin());
            std::ranges::copy(inputs.mean(Channel::Normal).plane(c), planes_.plane(Normal + c).begin());
        }
        const std::uint32_t used = inputs.has(Channel::Alpha) ? PlaneCount : Alpha;
        if (used > Alpha) std::ranges::copy(inputs.color(3), planes_.plane(Alpha).begin());
        if (std::ranges::all_of(inputs.counts.values(), [](float n) { return n > 0.0f; })) return true;
        one_object_.assign(inputs.pixel_count(), 1);
        views_.clear();
        for (std::uint32_t p = 0; p < used; ++p) views_.push_back({planes_.plane(p).data(), inputs.width});
        return holes_.run(inputs.counts, one_object_, views_, context);
    }

    // Three planes as an interleaved image, within the range that the network is trained for.
    bool interleave(Plane first, float minimum, float maximum, std::vector<float>& image,
                    RunContext& context) {
        return for_rows(context, height_, [&](std::uint32_t y) {
            float* to = image.data() + std::size_t{3} * y * width_;
            for (std::uint32_t c = 0; c < 3; ++c) {
                const float* from = planes_.row(first + c, y);
                for (std::uint32_t x = 0; x < width_; ++x)
                    to[3 * x + c] = std::clamp(from[x], minimum, maximum);
            }
        });
    }

    bool store_images(RunContext& context) {
        return interleave(Color, 0.0f, BrightestColor, color_, context) &&
               interleave(Albedo, 0.0f, 1.0f, albedo_, context) &&
               interleave(Normal, -1.0f, 1.0f, normal_, context);
    }

    // What the network makes of values beyond half floats is not specified: the unfiltered value replaces what is not finite.
    bool take_color(const Inputs& inputs, Planes& picture, RunContext& context) {
        return for_rows(context, inputs.height, [&](std::uint32_t y) {
            const float* from = output_.data() + std::size_t{3} * y * width_;
            for (std::uint32_t c = 0; c < 3; ++c) {
                const float* unfiltered = planes_.row(Color + c, y);
                float* to = picture.row(c, y);
                for (std::uint32_t x = 0; x < width_; ++x) {
                    const float value = from[3 * x + c];
                    to[x] = std::max(0.0f, std::isfinite(value) ? value : unfiltered[x]);
                }
            }
        });
    }

    bool filter_alpha(const Inputs& inputs, Planes& picture, RunContext& context) {
        const std::span<const float> alpha = planes_.plane(Alpha);
        if (std::ranges::all_of(alpha, [&](float a) { return a == alpha[0]; })) {
            std::ranges::copy(alpha, picture.plane(3).begin());
            return true;
        }
        const bool stored = for_rows(context, height_, [&](std::uint32_t y) {
            float* to = color_.data() + std::size_t{3} * y * width_;
            const float* from = planes_.row(Alpha, y);
            for (std::uint32_t i = 0; i < 3 * width_; ++i) to[i] = from[i / 3];
        });
        if (!stored || !network_->execute(context.stop)) return false;
        return for_rows(context, inputs.height, [&](std::uint32_t y) {
            const float* from = output_.data() + std::size_t{3} * y * width_;
            for (std::uint32_t x = 0; x < width_; ++x) {
                const float unfiltered = planes_.row(Alpha, y)[x];
                const bool kept = !std::isfinite(from[3 * x]) || is_constant_around(x, y);
                picture.row(3, y)[x] = std::clamp(kept ? unfiltered : from[3 * x], 0.0f, 1.0f);
            }
        });
    }

    bool is_constant_around(std::uint32_t x, std::uint32_t y) const {
        const std::uint32_t x0 = x - std::min(x, ConstantRadius), y0 = y - std::min(y, ConstantRadius);
        const std::uint32_t x1 = std::min(width_ - 1, x + ConstantRadius);
        const std::uint32_t y1 = std::min(height_ - 1, y + ConstantRadius);
        const float own = planes_.row(Alpha, y)[x];
        for (std::uint32_t j = y0; j <= y1; ++j) {
            const float* row = planes_.row(Alpha, j);
            if (std::any_of(row + x0, row + x1 + 1, [own](float a) { return a != own; })) return false;
        }
        return true;
    }

    std::uint32_t width_ = 0, height_ = 0;
    std::vector<float> color_, albedo_, normal_, output_;  // interleaved
    Planes planes_;
    svgf::HoleFill holes_;
    std::vector<std::uint32_t> one_object_;
    std::vector<svgf::PlaneView> views_;
    ConvergenceBlend convergence_blend_;
    std::unique_ptr<oidn::RayTracingFilter> network_;  // reads and writes the images
};

std::string why_no_library() {
    const auto library = oidn::installed_library();
    return library ? std::string() : library.error().what();
}

}  // namespace

FilterEntry oidn_entry() {
    return {
        .description = {.name = "oidn",
                        .summary =
                            "the neural network of Open Image Denoise, where that is installed; on the CPU",
                        .source = "Intel Open Image Denoise",
                        .bytes_per_pixel = 216,
                        .parameters = {{"blend",
                                        "",
                                        "blend back to the samples where filtering would increase the error",
                                        1,
                                        0,
                                        0,
                                        {"off", "on"}}},
                        .channels =
                            [](const Values&) {
                                return frame::ChannelSet{Channel::Radiance, Channel::Albedo, Channel::Normal};
                            },
                        .consistent = true,
                        .reads_variances = true,
                        .reproducible = false},
        .make = [](std::uint32_t, std::uint32_t) -> std::unique_ptr<Filter> {
            return std::make_unique<Oidn>();
        },
        .why_unavailable = &why_no_library};
}

}  // namespace tessera::filter
