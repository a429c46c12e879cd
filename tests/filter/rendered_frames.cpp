#include "tests/filter/rendered_frames.h"

#include <algorithm>

#include "mediator/picture/metrics.h"
#include "tests/support/folders.h"

namespace tessera::filter {

namespace {

using frame::Channel;

// Everything that psvgf and fdf read.
constexpr frame::ChannelSet RenderedChannels{
    Channel::Radiance, Channel::LowVariance, Channel::HighVariance, Channel::Irradiance,    Channel::Albedo,
    Channel::Normal,   Channel::Depth,       Channel::ObjectIndex,  Channel::ShadingFeature};

tools::bench::BenchScene rendered_scene(const std::string& name) {
    auto scene = tools::bench::load_scene(name, test::scenes_folder());
    if (!scene) throw scene.error();
    return std::move(*scene);
}

frame::Image colors_of(const Planes& picture) {
    Planes colors(picture.width(), picture.height(), 3);
    for (std::uint32_t c = 0; c < 3; ++c) std::ranges::copy(picture.plane(c), colors.plane(c).begin());
    return interleaved(colors);
}

}  // namespace

RenderedScene::RenderedScene(const std::string& name, std::uint32_t width, std::uint32_t height)
    : width_(width), height_(height), sampler_(rendered_scene(name), arena_) {}

frame::FilmTile RenderedScene::film(const view::View& view, std::uint64_t spp) const {
    tools::bench::GrowingFilm film = sampler_.film(view);
    sampler_.grow(film, spp, {});
    return film.whole();
}

Inputs RenderedScene::frame(std::uint64_t seed, std::uint64_t spp, view::PathClass path_class) const {
    const view::View view = sampler_.view(width_, height_, RenderedChannels, path_class, seed);
    Inputs inputs = make_inputs(film(view, spp), view);
    inputs.changes.film_restarted = true;
    return inputs;
}

Planes RenderedScene::reference(std::uint64_t seed, std::uint64_t spp) const {
    const view::View view =
        sampler_.view(width_, height_, {Channel::Radiance}, view::PathClass::Indirect, seed);
    return make_inputs(film(view, spp), view).mean(Channel::Radiance);
}

double ssim(const Planes& picture, const Planes& reference) {
    return picture::ssim(colors_of(picture), colors_of(reference));
}

void UnfilteredMean::add(const Inputs& frame) {
    const Planes& radiance = frame.mean(Channel::Radiance);
    if (sum_.empty()) sum_ = Planes(radiance.width(), radiance.height(), 3);
    for (std::size_t i = 0; i < sum_.values().size(); ++i) sum_.values()[i] += radiance.values()[i];
    frames_ += 1.0;
}

Planes UnfilteredMean::picture() const {
    Planes mean = sum_;
    for (float& value : mean.values()) value = static_cast<float>(value / frames_);
    return mean;
}

}  // namespace tessera::filter
