#include "master/filter/svgf/guides.h"

#include "master/filter/svgf/demodulate.h"

namespace tessera::filter::svgf {

namespace {

// Next to an edge one of the two differences crosses it; the other one belongs to the surface.
float smaller(float a, float b) {
    return std::fabs(a) < std::fabs(b) ? a : b;
}

// Where a surface reflects nothing, no sample says how much light falls on it: such pixels are a surface of their own. Else
// they would darken their neighbours, whose light would be lost on them.
constexpr std::uint32_t BlackSurface = 0x80000000u;

}  // namespace

bool prepare_guides(const Inputs& inputs, Guides& guides, RunContext& context) {
    shape(guides.normal, inputs, 3);
    shape(guides.inverse_depth, inputs, 1);
    guides.ids.resize(inputs.pixel_count());
    guides.camera = inputs.camera;
    const Planes& normals = inputs.mean(frame::Channel::Normal);
    const Planes& depths = inputs.mean(frame::Channel::Depth);
    const Planes& albedos = inputs.mean(frame::Channel::Albedo);
    return for_rows(context, inputs.height, [&](std::uint32_t y) {
        const std::size_t width = inputs.width;
        const float *nx = normals.row(0, y), *ny = normals.row(1, y), *nz = normals.row(2, y);
        float* __restrict ux = guides.normal.row(0, y);
        float* __restrict uy = guides.normal.row(1, y);
        float* __restrict uz = guides.normal.row(2, y);
        for (std::size_t x = 0; x < width; ++x) {
            const float square = nx[x] * nx[x] + ny[x] * ny[x] + nz[x] * nz[x];
            const float scale = square > Tiny ? 1.0f / std::sqrt(square) : 0.0f;
            ux[x] = nx[x] * scale;
            uy[x] = ny[x] * scale;
            uz[x] = nz[x] * scale;
        }
        const float* depth = depths.row(0, y);
        float* __restrict inverse = guides.inverse_depth.row(0, y);
        for (std::size_t x = 0; x < width; ++x) inverse[x] = depth[x] > Tiny ? 1.0f / depth[x] : 0.0f;
        const float *red = albedos.row(0, y), *green = albedos.row(1, y), *blue = albedos.row(2, y);
        const float* counts = inputs.counts.row(0, y);
        const std::uint32_t* ids = inputs.object_ids.data() + std::size_t{y} * width;
        std::uint32_t* __restrict surfaces = guides.ids.data() + std::size_t{y} * width;
        for (std::size_t x = 0; x < width; ++x) {
            const bool is_black = std::max(red[x], std::max(green[x], blue[x])) <= LeastAlbedo;
            surfaces[x] = is_black & (counts[x] > 0.0f) ? ids[x] ^ BlackSurface : ids[x];
        }
    });
}

bool prepare_slopes(Guides& guides, RunContext& context) {
    const std::uint32_t width = guides.inverse_depth.width(), height = guides.inverse_depth.height();
    if (guides.slope.width() != width || guides.slope.height() != height)
        guides.slope = Planes(width, height, 2);
    return for_rows(context, height, [&](std::uint32_t y) {
        const float* here = guides.inverse_depth.row(0, y);
        const float* above = guides.inverse_depth.row(0, y > 0 ? y - 1 : y);
        const float* below = guides.inverse_depth.row(0, y + 1 < height ? y + 1 : y);
        float* __restrict right = guides.slope.row(0, y);
        float* __restrict down = guides.slope.row(1, y);
        right[0] = width > 1 ? here[1] - here[0] : 0.0f;
        for (std::uint32_t x = 1; x + 1 < width; ++x) {
            right[x] = smaller(here[x + 1] - here[x], here[x] - here[x - 1]);
        }
        if (width > 1) right[width - 1] = here[width - 1] - here[width - 2];
        if (y == 0) above = below;
        if (y + 1 == height) below = above;
        const float sign_above = y == 0 ? -1.0f : 1.0f, sign_below = y + 1 == height ? -1.0f : 1.0f;
        for (std::uint32_t x = 0; x < width; ++x) {
            down[x] = smaller(sign_below * (below[x] - here[x]), sign_above * (here[x] - above[x]));
        }
    });
}

}  // namespace tessera::filter::svgf
