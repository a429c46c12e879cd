#include "master/render/output_reconstruction.h"

#include <immintrin.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstring>
#include <numeric>

#include "master/render/compose/layers.h"
#include "mediator/base/error.h"
#include "mediator/picture/srgb_bytes.h"
#include "mediator/picture/stereo_difference.h"

namespace tessera::master {

namespace {

using frame::Channel;

// Red, green and blue planes of a picture, and the sample counts to divide them by.
struct PictureLight {
    std::uint32_t width = 0, height = 0;
    std::array<const float*, 3> planes{};
    const std::uint32_t* counts = nullptr;  // not null: planes are sums over so many samples
};

template <class Store>
void for_each_pixel(const PictureLight& light, const picture::ViewTransform& transform,
                    tbb::task_arena& arena, const Store& store) {
    arena.execute([&] {
        tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, light.height, 32), [&](const auto& rows) {
            for (std::size_t i = std::size_t{rows.begin()} * light.width,
                             end = std::size_t{rows.end()} * light.width;
                 i < end; ++i) {
                float r = light.planes[0][i], g = light.planes[1][i], b = light.planes[2][i];
                if (light.counts != nullptr) {
                    const float weight = light.counts[i] == 0 ? 0.0f : 1.0f / float(light.counts[i]);
                    r *= weight;
                    g *= weight;
                    b *= weight;
                }
                const auto shown = transform(r, g, b);
                store(i, shown[0], shown[1], shown[2]);
            }
        });
    });
}

OutputResult::Picture encoded(const PictureLight& light, const picture::ViewTransform& transform,
                              session::PictureEncoding encoding, tbb::task_arena& arena) {
    static const picture::SrgbBytes to_srgb;
    const std::size_t pixels = std::size_t{light.width} * light.height;
    auto bytes = std::make_shared<std::vector<std::byte>>();
    if (encoding == session::PictureEncoding::Bytes) {
        bytes->resize(3 * pixels);
        auto* const out = reinterpret_cast<std::uint8_t*>(bytes->data());
        for_each_pixel(light, transform, arena, [&](std::size_t i, float r, float g, float b) {
            out[3 * i] = to_srgb(r);
            out[3 * i + 1] = to_srgb(g);
            out[3 * i + 2] = to_srgb(b);
        });
    } else {
        bytes->resize(6 * pixels);
        auto* const out = reinterpret_cast<std::uint16_t*>(bytes->data());
        for_each_pixel(light, transform, arena, [&](std::size_t i, float r, float g, float b) {
            out[3 * i] = static_cast<std::uint16_t>(_cvtss_sh(r, _MM_FROUND_TO_NEAREST_INT));
            out[3 * i + 1] = static_cast<std::uint16_t>(_cvtss_sh(g, _MM_FROUND_TO_NEAREST_INT));
            out[3 * i + 2] = static_cast<std::uint16_t>(_cvtss_sh(b, _MM_FROUND_TO_NEAREST_INT));
        });
    }
    return {light.width, light.height, std::move(bytes)};
}

// Unfiltered sums of colour are divided and encoded in one pass over the pixels.
bool is_plain(const view::View& view) {
    return view.filter.empty() && view.channels.contains(Channel::Color) &&
           !view.channels.contains(Channel::Alpha);
}

PictureLight light_of(const filter::Planes& picture) {
    PictureLight light{picture.width(), picture.height()};
    for (std::uint32_t c = 0; c < 3; ++c) light.planes[c] = picture.plane(c).data();
    return light;
}

PictureLight light_of(const frame::FilmTile& film, const view::View& view, const SceneState& scene,
                      Reconstructor& reconstructor) {
    PictureLight light{static_cast<std::uint32_t>(film.rect.width),
                       static_cast<std::uint32_t>(film.rect.height)};
    if (is_plain(view)) {
        const std::uint32_t first = film.channels.first_plane(Channel::Color);
        for (std::uint32_t c = 0; c < 3; ++c) light.planes[c] = film.plane(first + c).data();
        light.counts = film.counts.data();
        return light;
    }
    return light_of(reconstructor.filtered(film, view, scene));
}

// Copy of a filtered picture, for when several are needed at a time: r, g, b and, if present, alpha.
struct Copied {
    std::vector<std::vector<float>> planes;
    explicit Copied(const filter::Planes& picture) {
        for (std::uint32_t c = 0; c < picture.components(); ++c) {
            const auto plane = picture.plane(c);
            planes.emplace_back(plane.begin(), plane.end());
        }
    }
};

std::span<const float> depth_of(const frame::FilmTile& film) {
    if (!film.channels.contains(Channel::Depth))
        throw Error(ErrorCode::InvalidInput, "its film has no depth channel: render it with the colour");
    return film.plane(film.channels.first_plane(Channel::Depth));
}

// Composites the layers. Each was rendered without the objects of the others, on a transparent background.
void composite(std::span<const view::View> views, std::span<const frame::FilmTile> films,
               const SceneState& scene, Reconstructor& reconstructor, filter::Planes& out) {
    std::vector<Copied> copies;
    std::vector<Layer> layers;
    for (std::size_t i = 0; i < views.size(); ++i)
        copies.emplace_back(reconstructor.filtered(films[i], views[i], scene));
    for (std::size_t i = 0; i < views.size(); ++i) {
        const auto& planes = copies[i].planes;
        layers.push_back(
            {.color = {planes[0], planes[1], planes[2]}, .alpha = planes.at(3), .depth = depth_of(films[i])});
    }
    compose(layers, static_cast<std::uint32_t>(films.front().rect.width),
            static_cast<std::uint32_t>(films.front().rect.height), out, reconstructor.arena());
}

// One eye's picture as the input of stereo_difference: means, and the nearest depth of all layers.
struct MeasuredEye {
    std::array<std::vector<float>, 3> color;
    std::vector<float> depth;
    view::CameraPose camera;
    std::uint32_t width, height;

    MeasuredEye(const PictureLight& light, const OutputRequest::EyePicture& eye,
                std::span<const frame::FilmTile> films)
        : camera(eye.layers.front().camera), width(light.width), height(light.height) {
        const std::size_t pixels = std::size_t{width} * height;
        for (std::size_t c = 0; c < 3; ++c) {
            color[c].assign(light.planes[c], light.planes[c] + pixels);
            for (std::size_t i = 0; i < pixels && light.counts != nullptr; ++i)
                color[c][i] /= static_cast<float>(std::max(1u, light.counts[i]));
        }
        const auto first = depth_of(films.front());
        depth.assign(first.begin(), first.end());
        for (const frame::FilmTile& film : films.subspan(1)) {
            const auto other = depth_of(film);
            for (std::size_t i = 0; i < pixels; ++i) depth[i] = std::min(depth[i], other[i]);
        }
    }
    picture::EyeView view() const { return {width, height, color[0], color[1], color[2], depth, camera}; }
};

}  // namespace

OutputResult reconstruct_output(OutputRequest request, const std::vector<frame::FilmTile>& films,
                                Reconstructor& reconstructor) {
    OutputResult result{.request = std::move(request), .eyes = {}};
    result.samples = ~std::uint64_t{0};
    for (const frame::FilmTile& film : films) {
        const std::uint64_t all = std::accumulate(film.counts.begin(), film.counts.end(), std::uint64_t{0});
        result.samples = std::min(result.samples, all / film.counts.size());
    }
    try {
        const picture::ViewTransform& transform = result.request.transform;
        std::span<const frame::FilmTile> rest(films);
        std::vector<MeasuredEye> measured;
        filter::Planes composed;
        for (const OutputRequest::EyePicture& eye : result.request.eyes) {
            const auto own = rest.first(eye.layers.size());
            rest = rest.subspan(eye.layers.size());
            PictureLight light;
            if (own.size() == 1) {
                light = light_of(own.front(), eye.layers.front(), result.request.scene, reconstructor);
            } else {
                composite(eye.layers, own, result.request.scene, reconstructor, composed);
                light = light_of(composed);
            }
            result.eyes.push_back(encoded(light, transform, result.request.encoding, reconstructor.arena()));
            if (result.request.stereo_difference) measured.emplace_back(light, eye, own);
        }
        if (measured.size() == 2)
            result.stereo_difference =
                picture::stereo_difference(measured[0].view(), measured[1].view()).mean;
    } catch (const std::exception& error) {
        result.error = std::string("the picture of an output failed: ") + error.what();
        result.eyes.clear();
    }
    return result;
}

}  // namespace tessera::master
