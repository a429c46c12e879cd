#include "master/filter/nfor.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "master/filter/convergence_blend.h"
#include "master/filter/moderated_variance.h"
#include "master/filter/nfor/selection.h"
#include "master/filter/self_weight.h"
#include "master/filter/svgf/hole_fill.h"

namespace tessera::filter {

namespace {

using frame::Channel;
using namespace nfor;

enum Parameters : std::size_t { Radius, Patch, Stride, Pooled, UseConvergenceBlend };

constexpr std::uint32_t PoolRadius = 3;
constexpr std::uint32_t RefinementPatch = 1;  // of the second pass: less noise needs no larger patch

class Nfor final : public Filter {
  public:
    Report run(const Inputs& inputs, const Values& values, Output& out, RunContext context) override {
        Report report;
        shape(out.picture, inputs, inputs.color_components());
        if (inputs.halves[0].empty()) {
            report.notes.push_back(
                "the film has no half buffers: weights come from the samples that they are applied to");
        }
        report.stopped = !reconstruct(inputs, values, out, context, report);
        return report;
    }

  private:
    bool reconstruct(const Inputs& inputs, const Values& values, Output& out, RunContext& context,
                     Report& report) {
        CollaborativeSettings settings;
        settings.window.radius = static_cast<std::uint32_t>(values[Radius]);
        settings.window.patch = static_cast<std::uint32_t>(values[Patch]);
        settings.stride = 1u << static_cast<unsigned>(values[Stride]);
        {
            PassTimer timer(report, "variance", ModeratedVariance::Bytes + 4.0 * 30);
            if (!moderated_.run(inputs, static_cast<float>(values[Pooled]), PoolRadius, context))
                return false;
            features_.gather(inputs, context);
            if (!prepare_halves(inputs, context)) return false;
        }
        {
            PassTimer timer(report, "features", 4.0 * 5 * FeatureCount);
            if (!features_.prefilter(inputs, context)) return false;
        }
        const std::array<Half, 2> halves{half(0), half(1)};
        {
            PassTimer timer(report, "regression", 4.0 * 2 * (2 * (Colors + 1) * 3 + FeatureCount + 15));
            for (std::size_t h = 0; h < 2; ++h) {
                if (!collaborative_.run(halves[h], halves[1 - h], features_, settings, filtered_[h],
                                        context)) {
                    return false;
                }
            }
        }
        {
            PassTimer timer(report, "selection", 4.0 * (2 * 3 * 3 + 25 + 2 * 2 * Colors));
            if (!selection_.run(inputs, halves, filtered_, context) ||
                !combine(inputs, out.picture, context)) {
                return false;
            }
        }
        const bool has_halves = !inputs.halves[0].empty();
        if (has_halves) {
            PassTimer timer(report, "second regression", 4.0 * (3 * Colors + FeatureCount + 8));
            if (!refine(inputs, settings, out.picture, context)) return false;
        }
        if (out.wants_maps) out.maps = {{"bandwidth", selection_.first()}};
        if (values[UseConvergenceBlend] == 0.0) return true;
        PassTimer timer(report, "convergence blend",
                        ConvergenceBlend::bytes_per_pixel(out.picture.components()));
        std::span<const float> own;
        if (has_halves) {
            add_difference(inputs, context);
            if (!self_weight_.run(inputs, light_.plane(0), scale_.plane(0), refined_.plane(Colors - 1),
                                  out.picture, context))
                return false;
            own = self_weight_.weights();
        }
        if (!convergence_blend_.apply(inputs, Channel::Radiance, own, out.picture, context)) return false;
        if (out.wants_maps) out.maps.push_back({"blend", convergence_blend_.weights()});
        return true;
    }

    Half half(std::size_t h) const {
        return {
            {colors_[h].plane(0), colors_[h].plane(1), colors_[h].plane(2), alpha_.plane(0), alpha_.plane(0)},
            colors_[h],
            variances_[h],
            counts_[h]};
    }

    // Copies of the halves with holes filled, so that differences to a hole are finite and small. Pixels
    // without samples in one half take the mean of both halves.
    bool prepare_halves(const Inputs& inputs, RunContext& context) {
        const bool split = !inputs.halves[0].empty();
        shape(alpha_, inputs, 1);
        if (inputs.has(Channel::Alpha)) std::ranges::copy(inputs.color(3), alpha_.plane(0).begin());
        for (std::size_t h = 0; h < 2; ++h) {
            const Planes& from = split ? inputs.halves[h] : inputs.mean(Channel::Radiance);
            shape(colors_[h], inputs, 3);
            shape(variances_[h], inputs, 3);
            shape(counts_[h], inputs, 1);
            std::ranges::copy(from.values(), colors_[h].values().begin());
            for_rows(context, inputs.height, [&](std::uint32_t y) {
                const float* n = inputs.counts.row(0, y);
                const float* own = split ? inputs.half_counts[h].row(0, y) : n;
                float* counts = counts_[h].row(0, y);
                for (std::uint32_t x = 0; x < inputs.width; ++x)
                    counts[x] = std::max(own[x], std::min(n[x], 1.0f));
                for (std::uint32_t c = 0; c < 3; ++c) {
                    const float* variance = moderated_.variance().row(c, y);
                    float* to = variances_[h].row(c, y);
                    for (std::uint32_t x = 0; x < inputs.width; ++x) {
                        to[x] = variance[x] * n[x] / std::max(counts[x], 1.0f);
                    }
                }
            });
        }
        return fill_holes(inputs, context);
    }

    bool fill_holes(const Inputs& inputs, RunContext& context) {
        if (std::ranges::all_of(inputs.counts.values(), [](float n) { return n > 0.0f; })) return true;
        one_object_.assign(inputs.pixel_count(), 1);
        views_.clear();
        const auto add = [&](Planes& planes) {
            for (std::uint32_t c = 0; c < planes.components(); ++c) {
                views_.push_back({planes.plane(c).data(), inputs.width});
            }
        };
        for (Planes& planes : colors_) add(planes);
        for (Planes& planes : features_.raw()) add(planes);
        add(alpha_);
        return holes_.run(inputs.counts, one_object_, views_, context);
    }

    // The second pass: a fit to the mean of both filtered halves. Their difference shows the noise that is left.
    // It is filtered along, summed over r, g, b, for the self weight.
    bool refine(const Inputs& inputs, CollaborativeSettings settings, Planes& picture, RunContext& context) {
        settings.window.patch = std::min(settings.window.patch, RefinementPatch);
        const std::uint32_t width = inputs.width;
        shape(light_, inputs, 3);
        shape(last_, inputs, 2);
        shape(known_, inputs, 1);
        const bool gathered = for_rows(context, inputs.height, [&](std::uint32_t y) {
            const float* counts = inputs.counts.row(0, y);
            float* known = known_.row(0, y);
            for (std::uint32_t x = 0; x < width; ++x) known[x] = std::min(counts[x], 1.0f);
            float *alpha = last_.row(0, y), *sum = last_.row(1, y);
            std::fill_n(alpha, width, 1.0f);
            if (picture.components() > 3) std::copy_n(picture.row(3, y), width, alpha);
            std::fill_n(sum, width, 0.0f);
            for (std::uint32_t c = 0; c < 3; ++c) {
                std::copy_n(picture.row(c, y), width, light_.row(c, y));
                const float* difference = difference_.row(c, y);
                for (std::uint32_t x = 0; x < width; ++x) sum[x] += difference[x];
            }
        });
        const Half whole{{light_.plane(0), light_.plane(1), light_.plane(2), last_.plane(0), last_.plane(1)},
                         light_,
                         difference_,
                         known_,
                         true};
        if (!gathered ||
            !collaborative_.run(whole, whole, features_, settings, std::span(&refined_, 1), context)) {
            return false;
        }
        return for_rows(context, inputs.height, [&](std::uint32_t y) {
            for (std::uint32_t c = 0; c < picture.components(); ++c) {
                const float most = c == 3 ? 1.0f : std::numeric_limits<float>::max();
                const float* from = refined_.row(c, y);
                float* to = picture.row(c, y);
                for (std::uint32_t x = 0; x < width; ++x) to[x] = std::clamp(from[x], 0.0f, most);
            }
        });
    }

    // The difference of the halves, summed over r, g, b, in a plane of the second pass, which is over.
    void add_difference(const Inputs& inputs, RunContext& context) {
        for_rows(context, inputs.height, [&](std::uint32_t y) {
            float* to = light_.row(0, y);
            std::fill_n(to, inputs.width, 0.0f);
            for (std::uint32_t c = 0; c < 3; ++c) {
                const float *one = colors_[0].row(c, y), *two = colors_[1].row(c, y);
                for (std::uint32_t x = 0; x < inputs.width; ++x) to[x] += one[x] - two[x];
            }
        });
    }

    // The linear model may predict values outside the valid range: light >= 0, alpha within [0, 1].
    bool combine(const Inputs& inputs, Planes& picture, RunContext& context) {
        shape(difference_, inputs, 3);
        shape(scale_, inputs, 1);
        return for_rows(context, inputs.height, [&](std::uint32_t y) {
            const float* first = selection_.first().row(0, y);
            const float* counts[2] = {counts_[0].row(0, y), counts_[1].row(0, y)};
            float* scale = scale_.row(0, y);
            for (std::uint32_t x = 0; x < inputs.width; ++x) {
                const float all = counts[0][x] + counts[1][x];
                scale[x] = all > 0.0f ? std::sqrt(counts[0][x] / all * (counts[1][x] / all)) : 0.5f;
            }
            for (std::uint32_t c = 0; c < picture.components(); ++c) {
                const float most = c == 3 ? 1.0f : std::numeric_limits<float>::max();
                float* to = picture.row(c, y);
                float* difference = c < 3 ? difference_.row(c, y) : nullptr;
                const auto of = [&](std::size_t h, std::uint32_t x) {
                    const float narrow = filtered_[h][0].row(c, y)[x], wide = filtered_[h][1].row(c, y)[x];
                    return wide + first[x] * (narrow - wide);
                };
                for (std::uint32_t x = 0; x < inputs.width; ++x) {
                    const float all = counts[0][x] + counts[1][x];
                    const float weight = all > 0.0f ? counts[0][x] / all : 0.5f;
                    const float odd = of(1, x);
                    const float change = of(0, x) - odd;
                    to[x] = std::clamp(odd + weight * change, 0.0f, most);
                    if (difference) difference[x] = std::clamp(scale[x] * change, -1e15f, 1e15f);
                }
            }
        });
    }

    ModeratedVariance moderated_;
    Regressors features_;
    Collaborative collaborative_;
    Selection selection_;
    SelfWeight self_weight_;
    ConvergenceBlend convergence_blend_;
    svgf::HoleFill holes_;
    std::vector<std::uint32_t> one_object_;
    std::vector<svgf::PlaneView> views_;
    Planes alpha_;
    std::array<Planes, 2> colors_, variances_, counts_;
    std::array<std::array<Planes, 2>, 2> filtered_;  // by half, then bandwidth
    Planes scale_;                                   // sqrt(n_A n_B) / n
    Planes difference_;                              // of the filtered halves, times scale_
    Planes light_, last_, known_, refined_;          // of the second pass
};

}  // namespace

FilterEntry nfor_entry() {
    return {
        {.name = "nfor",
         .summary = "first-order regression on features, weights by NL-means of halves; slow",
         .source = "Bitterli et al. 2016",
         .bytes_per_pixel = 618,
         .parameters = {{"radius", "px", "radius of the window of a fit", 9, 1, MaxRadius, {}},
                        {"patch", "px", "radius of the patches compared for weights", 3, 0, MaxPatch, {}},
                        {"stride", "px", "distance between the centres of fits", 1, 0, 2, {"1", "2", "4"}},
                        {"pooled",
                         "",
                         "degrees of freedom that the neighbourhood adds to a pixel's variance",
                         4,
                         0,
                         64,
                         {}},
                        {"blend",
                         "",
                         "blend back to the samples where filtering would increase the error",
                         1,
                         0,
                         1,
                         {"off", "on"}}},
         .channels =
             [](const Values&) {
                 return frame::ChannelSet{Channel::Radiance, Channel::Albedo, Channel::Normal, Channel::Depth,
                                          Channel::FirstHalf};
             },
         .consistent = true,
         .reads_variances = true},
        [](std::uint32_t, std::uint32_t) -> std::unique_ptr<Filter> { return std::make_unique<Nfor>(); }};
}

}  // namespace tessera::filter
