#include "tests/filter/synthetic.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "master/filter/catalog.h"
#include "mediator/base/random.h"
#include "mediator/filter/choice.h"
#include "mediator/frame/block_stack.h"
#include "mediator/frame/merge.h"

namespace tessera::filter {

namespace {

using frame::Channel;

float root_of(float radiance) {
    return 2.0f * (std::sqrt(std::max(radiance, 0.0f)) - 1.0f);
}

void append(std::vector<float>& values, const SyntheticSample& s, frame::ChannelSet channels) {
    const auto add = [&](Channel channel, const auto& numbers) {
        if (channels.contains(channel)) values.insert(values.end(), numbers.begin(), numbers.end());
    };
    const std::array<float, 3> radiance{s.low[0] + s.high[0], s.low[1] + s.high[1], s.low[2] + s.high[2]};
    add(Channel::Radiance, radiance);
    add(Channel::LowVariance, s.low);
    add(Channel::HighVariance, s.high);
    add(Channel::Albedo, s.albedo);
    add(Channel::Normal, s.normal);
    add(Channel::Depth, std::array{s.depth});
    add(Channel::ObjectIndex, std::array{s.depth, std::bit_cast<float>(s.object)});
    add(Channel::Alpha, std::array{s.alpha});
    add(Channel::Headlight, s.headlight);
    add(Channel::ShadingFeature, std::array{s.shading});
    add(Channel::Irradiance, s.irradiance);
    add(Channel::Color, radiance);
    add(Channel::Root, std::array{root_of(radiance[0]), root_of(radiance[1]), root_of(radiance[2])});
}

struct TextureAndLight {
    std::array<float, 3> albedo, normal;
    double light;
};

TextureAndLight shadowed_texture_at(std::uint32_t width, std::uint32_t height, std::uint32_t x,
                                    std::uint32_t y) {
    const bool checker = x < width / 2;
    const double value = checker ? ((x / 6 + y / 6) % 2 == 0 ? 0.3 : 0.8) : 0.5 + 0.05 * std::sin(0.9 * x);
    const bool tilted = y < height / 3;
    const double dx = x - 0.3 * width, dy = y - 0.6 * height;
    const double disc = dx * dx + dy * dy < 25.0 * 25.0 ? 0.15 : 0.9;
    const double t = std::clamp(((x + y) - 0.5 * (width + height)) / 60.0 + 0.5, 0.0, 1.0);
    const double penumbra = 0.9 - 0.6 * t * t * (3.0 - 2.0 * t);
    const auto a = static_cast<float>(value);
    return {{a, 0.8f * a, 0.6f * a},
            tilted ? std::array{0.0f, 0.6f, 0.8f} : std::array{0.0f, 0.0f, 1.0f},
            std::min(disc, penumbra) * (tilted ? 0.6 : 1.0)};
}

}  // namespace

frame::FilmTile synthetic_film(std::uint32_t width, std::uint32_t height, std::uint64_t n,
                               frame::ChannelSet channels, const Sampler& sampler) {
    const Rect rect{0, 0, static_cast<std::int32_t>(width), static_cast<std::int32_t>(height)};
    frame::BlockStack stack;
    std::vector<float> values;
    for (std::uint64_t i = 0; i < n; ++i) {
        frame::FilmTile tile = stack.recycled(rect, {i, 0}, channels);
        for (std::uint32_t y = 0; y < height; ++y) {
            for (std::uint32_t x = 0; x < width; ++x) {
                values.clear();
                append(values, sampler(x, y, i), channels);
                frame::put_sample(tile, std::size_t{y} * width + x, values);
            }
        }
        stack.push(std::move(tile));
    }
    std::vector<frame::FilmTile> blocks = stack.take();
    frame::FilmTile film =
        blocks.empty() ? frame::FilmTile(rect, {0, 0}, channels) : std::move(blocks.front());
    for (std::size_t i = 1; i < blocks.size(); ++i) frame::merge(film, blocks[i]);
    return film;
}

view::View synthetic_view(std::uint32_t width, std::uint32_t height) {
    view::View view;
    view.width = width;
    view.height = height;
    view.window = {0, 0, static_cast<std::int32_t>(width), static_cast<std::int32_t>(height)};
    view.camera = view::perspective(glm::dmat4(1.0), 0.8, double(width) / height);
    return view;
}

Inputs synthetic_inputs(std::uint32_t width, std::uint32_t height, std::uint64_t n, const Sampler& sampler,
                        frame::ChannelSet channels) {
    return make_inputs(synthetic_film(width, height, n, channels, sampler), synthetic_view(width, height));
}

SyntheticSample shadowed_texture(std::uint32_t width, std::uint32_t height, std::uint32_t x, std::uint32_t y,
                                 std::uint64_t sample, std::uint64_t seed) {
    const TextureAndLight here = shadowed_texture_at(width, height, x, y);
    CounterRandom random(mix(seed), mix((std::uint64_t{y} << 32 | x) ^ mix(sample)));
    const float found = random.uniform() < here.light ? 1.0f : 0.0f;
    SyntheticSample s;
    s.albedo = here.albedo;
    s.normal = here.normal;
    for (int c = 0; c < 3; ++c) {
        s.high[c] = here.albedo[c] * found;
        s.irradiance[c] = found;
        s.headlight[c] = here.albedo[c] * (1.0f + here.normal[2]) / 2.0f;
    }
    s.shading = found;
    return s;
}

Planes shadowed_texture_truth(std::uint32_t width, std::uint32_t height) {
    Planes truth(width, height, 3);
    for (std::uint32_t y = 0; y < height; ++y) {
        for (std::uint32_t x = 0; x < width; ++x) {
            const TextureAndLight here = shadowed_texture_at(width, height, x, y);
            for (std::uint32_t c = 0; c < 3; ++c) {
                truth.row(c, y)[x] = static_cast<float>(here.albedo[c] * here.light);
            }
        }
    }
    return truth;
}

Output run_filter(const std::string& choice, const Inputs& inputs, bool wants_maps) {
    const Choice chosen = parse_choice(choice, catalog()).value();
    const auto filter = chosen.entry->make(inputs.width, inputs.height);
    Output out;
    out.wants_maps = wants_maps;
    tbb::task_arena arena(2);
    filter->run(inputs, chosen.values, out, {arena, {}});
    return out;
}

double mean_squared_error(const Planes& a, const Planes& b) {
    double sum = 0.0;
    for (std::uint32_t c = 0; c < std::min(a.components(), b.components()); ++c) {
        for (std::size_t i = 0; i < a.pixel_count(); ++i) {
            const double d = double(a.plane(c)[i]) - double(b.plane(c)[i]);
            sum += d * d;
        }
    }
    return sum / static_cast<double>(a.pixel_count());
}

}  // namespace tessera::filter
