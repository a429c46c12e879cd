#include "master/filter/gauss.h"

#include <algorithm>

#include "master/filter/far_holes.h"
#include "master/filter/kernels.h"

namespace tessera::filter {

namespace {

enum Parameters : std::size_t { Sigma };

// Holes have no weight: they are filled and do not darken their neighbours.
class Gauss final : public Filter {
  public:
    Report run(const Inputs& inputs, const Values& values, Output& out, RunContext context) override {
        const auto sigma = static_cast<float>(values[Sigma]);
        const auto radius = static_cast<std::int64_t>(std::ceil(3.0f * sigma));
        kernel_.resize(static_cast<std::size_t>(radius) + 1);
        for (std::int64_t i = 0; i <= radius; ++i) {
            const float t = static_cast<float>(i) / std::max(sigma, 1e-6f);
            kernel_[static_cast<std::size_t>(i)] = exp_negative(-0.5f * t * t);
        }
        const std::uint32_t components = inputs.color_components();
        shape(out.picture, inputs, components);
        shape(rows_, inputs, components + 1);
        shape(weights_, inputs, 1);
        Report report;
        PassTimer timer(report, "gauss", 4.0 * (4 * components + 4));
        const bool done =
            for_rows(context, inputs.height, [&](std::uint32_t y) { blur_row(inputs, y, radius); }) &&
            for_rows(context, inputs.height, [&](std::uint32_t y) { blur_column(out.picture, y, radius); }) &&
            far_holes_.fill(weights_, out.picture, context);
        report.stopped = !done;
        return report;
    }

  private:
    void blur_row(const Inputs& inputs, std::uint32_t y, std::int64_t radius) {
        const std::uint32_t components = rows_.components() - 1;
        const std::int64_t width = inputs.width;
        const float* counts = inputs.counts.row(0, y);
        float* weights = rows_.row(components, y);
        std::fill(weights, weights + width, 0.0f);
        for (std::uint32_t c = 0; c < components; ++c) {
            const float* from = inputs.color(c).data() + std::size_t{y} * inputs.width;
            float* to = rows_.row(c, y);
            std::fill(to, to + width, 0.0f);
            for (std::int64_t d = -radius; d <= radius; ++d) {
                const float k = kernel_[static_cast<std::size_t>(std::abs(d))];
                const std::int64_t first = std::max<std::int64_t>(0, -d), last = std::min(width, width - d);
                for (std::int64_t x = first; x < last; ++x) {
                    const float w = counts[x + d] > 0.0f ? k : 0.0f;
                    to[x] += w * from[x + d];
                    if (c == 0) weights[x] += w;
                }
            }
        }
    }

    void blur_column(Planes& out, std::uint32_t y, std::int64_t radius) {
        const std::uint32_t components = out.components();
        const std::int64_t width = out.width(), height = out.height();
        const std::int64_t first = std::max<std::int64_t>(0, y - radius),
                           last = std::min(height, y + radius + 1);
        const auto gather = [&](std::uint32_t from_component, float* to) {
            std::fill(to, to + width, 0.0f);
            for (std::int64_t row = first; row < last; ++row) {
                const float k = kernel_[static_cast<std::size_t>(std::abs(row - std::int64_t{y}))];
                const float* from = rows_.row(from_component, static_cast<std::uint32_t>(row));
                for (std::int64_t x = 0; x < width; ++x) to[x] += k * from[x];
            }
        };
        float* weights = weights_.row(0, y);
        gather(components, weights);
        for (std::uint32_t c = 0; c < components; ++c) {
            float* to = out.row(c, y);
            gather(c, to);
            for (std::int64_t x = 0; x < width; ++x) {
                const float w = weights[x];
                to[x] = w > 0.0f ? to[x] / w : 0.0f;
            }
        }
    }

    std::vector<float> kernel_;
    Planes rows_, weights_;
    FarHoles far_holes_;
};

}  // namespace

FilterEntry gauss_entry() {
    return {
        {.name = "gauss",
         .summary = "Gaussian blur; the baseline, not edge-preserving",
         .source = "",
         .bytes_per_pixel = 28,
         .parameters = {{"sigma", "px", "standard deviation", 2.0, 0.1, 64.0, {}}},
         .channels = [](const Values&) { return frame::ChannelSet{frame::Channel::Radiance}; }},
        [](std::uint32_t, std::uint32_t) -> std::unique_ptr<Filter> { return std::make_unique<Gauss>(); }};
}

}  // namespace tessera::filter
