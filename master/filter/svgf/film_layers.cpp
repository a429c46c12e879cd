#include "master/filter/svgf/film_layers.h"

#include "master/filter/svgf/demodulate.h"

namespace tessera::filter::svgf {

namespace {

using frame::Channel;

void copy(const Planes*& layer, Planes& own, const Inputs& inputs) {
    if (layer == &own) return;
    shape(own, inputs, layer->components());
    std::ranges::copy(layer->values(), own.values().begin());
    layer = &own;
}

}  // namespace

Coverage coverage_of(const Inputs& inputs) {
    const auto counts = inputs.counts.plane(0);
    std::array<float, 8> least;
    least.fill(counts.empty() ? 0.0f : counts[0]);
    Coverage coverage;
    for (std::uint32_t y = 0; y < inputs.height; ++y) {
        const float* row = inputs.counts.row(0, y);
        std::array<float, 8> sums{};
        for (std::uint32_t x = 0; x + 8 <= inputs.width; x += 8) {
            for (std::uint32_t k = 0; k < 8; ++k) {
                sums[k] += row[x + k];
                least[k] = std::min(least[k], row[x + k]);
            }
        }
        for (std::uint32_t x = inputs.width / 8 * 8; x < inputs.width; ++x) {
            sums[0] += row[x];
            least[0] = std::min(least[0], row[x]);
        }
        for (const float sum : sums) coverage.samples += sum;
    }
    coverage.least = *std::ranges::min_element(least);
    return coverage;
}

bool FilmLayers::read(const Inputs& inputs, bool holes, std::span<Signal> signals, Guides& guides,
                      Report& report, RunContext& context) {
    albedo_ = &inputs.mean(Channel::Albedo);
    alpha_ = inputs.has(Channel::Alpha) ? &inputs.mean(Channel::Alpha) : nullptr;
    {
        PassTimer timer(report, "demodulate", 4.0 * (3 + 3 + 3 + 3 + 1 + 6));
        if (!demodulate(inputs, signals[0].now(), context)) return false;
        if (!find_rest(inputs, own_rest_, rest_, context)) return false;
        if (signals.size() > 1 && !take_rest(inputs, *rest_, signals[1].now(), context)) return false;
    }
    {
        PassTimer timer(report, "guides", 4.0 * (5 + 5));
        if (!prepare_guides(inputs, guides, context)) return false;
    }
    if (holes) {
        PassTimer timer(report, "holes", 4.0 * 2 * 20);
        if (!fill_holes(inputs, signals, guides, context)) return false;
    }
    PassTimer timer(report, "slopes", 4.0 * 3);
    return prepare_slopes(guides, context);
}

bool FilmLayers::fill_holes(const Inputs& inputs, std::span<Signal> signals, Guides& guides,
                            RunContext& context) {
    copy(albedo_, own_albedo_, inputs);
    copy(rest_, own_rest_, inputs);
    filled_.clear();
    const auto add = [&](Planes& from, std::uint32_t count) {
        for (std::uint32_t c = 0; c < count; ++c) filled_.push_back({from.row(c, 0), from.width()});
    };
    add(guides.normal, 3);
    add(guides.inverse_depth, 1);
    add(own_albedo_, 3);
    add(own_rest_, 3);
    if (alpha_ != nullptr) {
        copy(alpha_, own_alpha_, inputs);
        add(own_alpha_, 1);
    }
    for (Signal& signal : signals) {
        State& state = signal.now();
        for (std::uint32_t c = 0; c < 3; ++c) filled_.push_back({state.color.row(c, 0), state.color.pitch()});
        add(state.moments, Age);  // but not the age: there are no samples
    }
    return hole_fill_.run(inputs.counts, guides.ids, filled_, context);
}

void FilmLayers::keep(const Inputs& inputs) {
    copy(albedo_, own_albedo_, inputs);
    copy(rest_, own_rest_, inputs);
    if (alpha_ != nullptr) {
        copy(alpha_, own_alpha_, inputs);
    } else {
        own_alpha_ = {};
    }
    known_ = true;
}

void FilmLayers::restart() {
    has_before_ = known_;
    if (!known_) return;
    std::swap(own_albedo_, albedo_before_);
    std::swap(own_rest_, rest_before_);
    std::swap(own_alpha_, alpha_before_);
    known_ = false;
}

bool FilmLayers::blend_history(const State& light, Report& report, RunContext& context) {
    PassTimer timer(report, "layers", 4.0 * (3 * 7 + 1));
    const auto blend = [&](const Planes*& layer, Planes& own, const Planes& before) {
        const Planes& film = *layer;
        if (&film != &own) own.resize(film.width(), film.height(), film.components());
        layer = &own;
        return for_rows(context, film.height(), [&](std::uint32_t y) {
            const float* weight = light.color.row(OwnWeightComponent, y);
            for (std::uint32_t c = 0; c < film.components(); ++c) {
                const float *now = film.row(c, y), *old = before.row(c, y);
                float* to = own.row(c, y);
                for (std::uint32_t x = 0; x < film.width(); ++x)
                    to[x] = weight[x] * now[x] + (1.0f - weight[x]) * old[x];
            }
        });
    };
    return blend(albedo_, own_albedo_, albedo_before_) && blend(rest_, own_rest_, rest_before_) &&
           (alpha_ == nullptr || blend(alpha_, own_alpha_, alpha_before_));
}

bool FilmLayers::compose(const Inputs& inputs, std::span<const Signal> signals, Planes& picture,
                         Report& report, RunContext& context) const {
    return compose(inputs, signals, *rest_, picture, report, context);
}

bool FilmLayers::compose(const Inputs& inputs, std::span<const Signal> signals, const Planes& unfiltered,
                         Planes& picture, Report& report, RunContext& context) const {
    PassTimer timer(report, "compose", 4.0 * 12);
    const PaddedPlanes& light = signals[0].filtered();
    return for_rows(context, inputs.height, [&](std::uint32_t y) {
        const std::size_t width = inputs.width;
        for (std::uint32_t c = 0; c < 3; ++c) {
            const float *a = albedo_->row(c, y), *e = light.row(c, y);
            const float* rest = signals.size() > 1 ? signals[1].filtered().row(c, y) : unfiltered.row(c, y);
            float* __restrict to = picture.row(c, y);
            for (std::size_t x = 0; x < width; ++x) to[x] = a[x] * e[x] + rest[x];
        }
        if (picture.components() == 4) std::copy_n(alpha_->row(0, y), width, picture.row(3, y));
    });
}

}  // namespace tessera::filter::svgf
