#include "tests/contract/filter_cases.h"

#include <bit>
#include <cmath>
#include <limits>
#include <sstream>

#include "mediator/base/random.h"

namespace tessera::filter::test {

namespace {

using frame::Channel;
std::string text(const auto&... parts) {
    std::ostringstream stream;
    (stream << ... << parts);
    return stream.str();
}

constexpr float Infinity = std::numeric_limits<float>::infinity();

CounterRandom stream(std::uint64_t seed, std::uint32_t x, std::uint32_t y, std::uint64_t sample) {
    return CounterRandom(mix(seed), mix((std::uint64_t{y} << 32 | x) ^ mix(sample)));
}

SyntheticSample miss() {
    SyntheticSample s;
    s.albedo = s.normal = s.headlight = {};
    s.depth = Infinity;
    s.alpha = 0.0f;
    s.object = 0;
    return s;
}

// Features that differ strongly between neighbours, so that only the center of a window gets weight.
SyntheticSample lonely(std::uint32_t x, std::uint32_t y, std::uint64_t sample) {
    CounterRandom place = stream(3, x, y, 0), light = stream(4, x, y, sample);
    SyntheticSample s;
    const auto number = static_cast<float>(31 * (x % 5) + 7 * (y % 7) + 1);
    for (int c = 0; c < 3; ++c) {
        s.albedo[c] = 1e3f * number * static_cast<float>(place.uniform());
        s.normal[c] = static_cast<float>(2.0 * place.uniform() - 1.0);
        s.headlight[c] = static_cast<float>(place.uniform());
        s.high[c] = 1e4f * number + static_cast<float>(light.uniform());
        s.irradiance[c] = 1e4f * number;
    }
    s.depth = std::pow(10.0f, static_cast<float>(12.0 * place.uniform() - 6.0));
    s.shading = 100.0f * number;
    s.object = x + 1000 * y + 1;
    return s;
}

// Neighbouring values from 1e-`decades` to 1e+`decades`. Without noise the whole range of a float is
// asked for; with it the squares of the deviations have to be floats as well.
SyntheticSample wide_range(std::uint32_t x, std::uint32_t y, std::uint64_t sample, double decades,
                           double noise) {
    CounterRandom place = stream(5, x, y, 0), light = stream(6, x, y, sample);
    SyntheticSample s;
    const double base = std::pow(10.0, decades * ((x + y) % 2 == 0 ? 1.0 : -1.0) * place.uniform());
    for (int c = 0; c < 3; ++c) {
        s.irradiance[c] = static_cast<float>(base * (1.0 + noise * light.uniform()));
        s.high[c] = s.irradiance[c];
    }
    s.shading = s.high[0];
    return s;
}

Inputs of_room(std::uint32_t width, std::uint32_t height, std::uint64_t n, const auto& change) {
    return synthetic_inputs(width, height, n, [&](auto x, auto y, auto i) {
        SyntheticSample s = room(width, height, x, y, i);
        change(s, x, y, i);
        return s;
    });
}

}  // namespace

SyntheticSample room(std::uint32_t width, std::uint32_t height, std::uint32_t x, std::uint32_t y,
                     std::uint64_t sample) {
    CounterRandom random = stream(1, x, y, sample);
    const double direct = random.uniform(), found = random.uniform(), rare = random.uniform(),
                 covered = random.uniform();
    const std::uint32_t horizon = height / 5;
    if (y < horizon || (y == horizon && covered < 0.5)) return miss();
    SyntheticSample s;
    const float shade = (x / 4 + y / 4) % 2 == 0 ? 0.3f : 0.8f;
    s.albedo = {shade, 0.8f * shade, 0.5f};
    s.normal = 3 * x < width       ? std::array{0.0f, 0.0f, 1.0f}
               : 3 * x < 2 * width ? std::array{0.6f, 0.0f, 0.8f}
                                   : std::array{0.0f, 1.0f, 0.0f};
    const bool near = 2 * x < width;
    s.depth = (near ? 2.0f : 3.0f) + 0.002f * static_cast<float>(y);
    s.object = near ? 7 : 9;
    const float light = (found < 0.4 ? 1.0f : 0.0f) + (rare < 0.02 ? 20.0f : 0.0f);
    for (int c = 0; c < 3; ++c) {
        s.low[c] = 0.3f * s.albedo[c] * static_cast<float>(0.5 + direct);
        s.high[c] = s.albedo[c] * light;
        s.irradiance[c] = light;
        s.headlight[c] = s.albedo[c] * (0.4f + 0.3f * (1.0f + s.normal[2]));
    }
    s.shading = light;
    return s;
}

Inputs room_inputs(std::uint32_t width, std::uint32_t height, std::uint64_t n) {
    return of_room(width, height, n, [](auto&&...) {});
}

SyntheticSample rejected() {
    SyntheticSample s;
    s.low[0] = std::numeric_limits<float>::quiet_NaN();
    return s;
}

Inputs constant_inputs(std::uint32_t width, std::uint32_t height, std::uint64_t n, const Sampler& features) {
    return synthetic_inputs(width, height, n, [&](auto x, auto y, auto i) {
        SyntheticSample s = features(x, y, i);
        if (std::isnan(s.low[0])) return s;
        s.albedo = {1.0f, 1.0f, 1.0f};
        for (int c = 0; c < 3; ++c) {
            s.irradiance[c] = s.high[c] = 0.75f * ConstantColor[c];
            s.low[c] = 0.25f * ConstantColor[c];
        }
        s.alpha = 1.0f;
        return s;
    });
}

std::vector<MalformedCase> malformed_cases() {
    const auto is_hole = [](std::uint32_t x, std::uint32_t y) { return stream(2, x, y, 0).uniform() < 0.9; };
    std::vector<MalformedCase> cases;
    cases.push_back({"no samples anywhere", room_inputs(24, 18, 0)});
    cases.push_back(
        {"nine pixels of ten without samples", of_room(24, 18, 3, [&](auto& s, auto x, auto y, auto) {
             if (is_hole(x, y)) s = rejected();
         })});
    cases.push_back({"one sample in some pixels, none in the others",
                     of_room(24, 18, 1, [&](auto& s, auto x, auto y, auto) {
                         if (is_hole(x, y)) s = rejected();
                     })});
    cases.push_back({"one sample", room_inputs(24, 18, 1)});
    cases.push_back({"two samples", room_inputs(24, 18, 2)});
    cases.push_back({"empty background", of_room(24, 18, 4, [](auto& s, auto...) { s = miss(); })});
    cases.push_back({"bright background", of_room(24, 18, 4, [](auto& s, auto...) {
                         s = miss();
                         s.low = s.headlight = {5.0f, 6.0f, 7.0f};
                     })});
    cases.push_back({"no variance",
                     of_room(24, 18, 4, [](auto& s, auto x, auto y, auto) { s = room(24, 18, x, y, 0); })});
    cases.push_back({"infinite depth in one half", of_room(24, 18, 4, [](auto& s, auto x, auto, auto) {
                         if (x >= 12) s.depth = Infinity;
                     })});
    cases.push_back({"pixels without a like neighbour",
                     of_room(24, 18, 4, [](auto& s, auto x, auto y, auto i) { s = lonely(x, y, i); })});
    cases.push_back({"forty decades without noise", of_room(24, 18, 4, [](auto& s, auto x, auto y, auto i) {
                         s = wide_range(x, y, i, 20.0, 0.0);
                     })});
    cases.push_back({"thirty decades with noise", of_room(24, 18, 4, [](auto& s, auto x, auto y, auto i) {
                         s = wide_range(x, y, i, 15.0, 1.0);
                     })});
    cases.push_back({"black", of_room(24, 18, 4, [](auto& s, auto...) {
                         s.low = s.high = s.irradiance = s.albedo = s.headlight = {};
                         s.shading = 0.0f;
                     })});
    for (const auto [width, height] : {std::array{1u, 1u}, {1u, 7u}, {3u, 2u}, {16u, 16u}}) {
        cases.push_back({text(width, " x ", height), room_inputs(width, height, 4)});
    }
    return cases;
}

Subject::Subject(const FilterEntry& entry, const Inputs& inputs, int threads)
    : values(default_values(entry.description)),
      filter(entry.make(inputs.width, inputs.height)),
      arena(threads) {}

std::vector<float> Subject::numbers(const Inputs& inputs, bool with_maps) {
    out.wants_maps = with_maps;
    picture(inputs);
    std::vector<float> all(out.picture.values().begin(), out.picture.values().end());
    for (const DebugMap& map : out.maps) {
        all.insert(all.end(), map.planes.values().begin(), map.planes.values().end());
    }
    return all;
}

const Planes& Subject::picture(const Inputs& inputs) {
    report = filter->run(inputs, values, out, {arena, {}});
    return out.picture;
}

std::string first_difference(std::span<const float> a, std::span<const float> b) {
    if (a.size() != b.size()) return text(a.size(), " and ", b.size(), " numbers");
    for (std::size_t i = 0; i < a.size(); ++i) {
        if (std::bit_cast<std::uint32_t>(a[i]) != std::bit_cast<std::uint32_t>(b[i])) {
            return text("number ", i, " of ", a.size(), ": ", a[i], " and ", b[i]);
        }
    }
    return {};
}

std::string first_not_finite(const Planes& planes) {
    for (std::uint32_t c = 0; c < planes.components(); ++c) {
        for (std::size_t i = 0; i < planes.pixel_count(); ++i) {
            const float value = planes.plane(c)[i];
            if (!std::isfinite(value)) {
                return text("component ", c, " at (", i % planes.width(), ", ", i / planes.width(), ") is ",
                            value);
            }
        }
    }
    return {};
}

std::string filter_name(const testing::TestParamInfo<std::size_t>& tested) {
    return std::string(catalog()[tested.param].description.name);
}

}  // namespace tessera::filter::test
