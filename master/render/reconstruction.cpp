#include "master/render/reconstruction.h"

#include <algorithm>
#include <cstring>
#include <optional>
#include <utility>

#include "master/filter/catalog.h"
#include "master/filter/upsample.h"
#include "mediator/picture/exposure.h"
#include "mediator/picture/mark_tiles.h"
#include "mediator/picture/picture_encoder.h"

namespace tessera::master {

namespace {

using Clock = std::chrono::steady_clock;

double since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

std::optional<picture::FileFormat> file_format(session::PictureEncoding encoding) {
    switch (encoding) {
        case session::PictureEncoding::Png:
            return picture::FileFormat::Png;
        case session::PictureEncoding::Jpeg:
            return picture::FileFormat::Jpeg;
        case session::PictureEncoding::Exr:
            return picture::FileFormat::Exr;
        case session::PictureEncoding::Planes:
        case session::PictureEncoding::None:
        case session::PictureEncoding::Bytes:  // of outputs: master/render/output_reconstruction.h
        case session::PictureEncoding::Half:
            break;
    }
    return std::nullopt;
}

}  // namespace

filter::Filter& Reconstructor::instance(const filter::Choice& choice, const view::View& view,
                                        const SceneState& scene, filter::Inputs& inputs) {
    const filter::Description& description = choice.entry->description;
    const InstanceKey key{std::string(description.name), inputs.width, inputs.height,
                          description.needs_own_instance() ? view.id : ViewId{}};
    inputs.changes = {};
    User& user = users_[view.id];
    if (user.key != key) {
        const auto found = instances_.find(key);
        auto made = found != instances_.end() ? nullptr : choice.entry->make(inputs.width, inputs.height);
        Instance& entered = instances_[key];
        if (made) entered.filter = std::move(made);
        ++entered.users;
        release(std::exchange(user.key, key));
    } else {
        inputs.changes = {.film_restarted = user.revision != view.revision,
                          .lights_or_materials = user.version < scene.edits.lights_or_materials,
                          .geometry = user.version < scene.edits.geometry};
    }
    user.revision = view.revision;
    user.version = scene.version;
    return *instances_.at(key).filter;
}

void Reconstructor::release(const InstanceKey& key) {
    const auto found = instances_.find(key);
    if (found != instances_.end() && --found->second.users == 0) instances_.erase(found);
}

void Reconstructor::forget(ViewId first, ViewId last) {
    for (auto user = users_.lower_bound(first); user != users_.lower_bound(last);) {
        release(user->second.key);
        user = users_.erase(user);
    }
    exposures_.erase(exposures_.lower_bound(first), exposures_.lower_bound(last));
}

std::vector<std::byte> Reconstructor::encode(const filter::Planes& picture, const PictureFormat& format,
                                             session::PictureSummary& summary) {
    const auto file = file_format(format.encoding);
    if (!file) {
        const auto bytes = std::as_bytes(picture.values());
        return {bytes.begin(), bytes.end()};
    }
    frame::Image image = interleaved(picture);
    if (*file != picture::FileFormat::Exr) {
        view::DisplayTransform& transform = summary.display_transform;
        transform = format.transform;
        if (const auto known = exposures_.find(format.view); !transform.exposure && known != exposures_.end())
            transform.exposure = known->second;
        if (!transform.exposure) {
            transform.exposure = picture::measured_exposure(image);
            if (transform.exposure) exposures_[format.view] = *transform.exposure;
        }
    }
    if (*file != picture::FileFormat::Exr) {
        picture::mark_tiles(image, format.failed_tiles, summary.display_transform.exposure.value_or(0.0),
                            format.window.x, format.window.y);
    }
    return picture::encode_picture(image, *file, summary.display_transform);
}

Reconstruction Reconstructor::reconstruct(const Films& films, const view::View& view, const SceneState& scene,
                                          const PictureFormat& format) {
    Reconstruction result{.bytes = std::make_shared<const std::vector<std::byte>>()};
    session::PictureSummary& summary = result.summary;
    const auto choice = filter::parse_choice(view.filter, filter::catalog());
    if (!choice) {
        result.error = choice.error().what();
        return result;
    }
    summary.filter = filter::to_text(*choice);
    try {
        const auto started = Clock::now();
        filter::resolve_inputs(films.film, view, films.later, inputs_);
        filter::Filter& filter = instance(*choice, view, scene, inputs_);
        const filter::Report report = filter.run(inputs_, choice->values, output_, {arena_, {}});
        const filter::Planes* picture = &output_.picture;
        if (films.features != nullptr) {
            filter::resolve_inputs(*films.features, view, nullptr, full_inputs_);
            filter::upsample(output_.picture, inputs_, full_inputs_, upsampled_, {arena_, {}});
            picture = &upsampled_;
        }
        summary.seconds_filter = since(started);
        for (const filter::Pass& pass : report.passes) {
            summary.passes.push_back({std::string(pass.name), seconds(pass.time), pass.bytes_per_pixel});
        }
        summary.notes.assign(report.notes.begin(), report.notes.end());
        const auto filtered = Clock::now();
        result.bytes = std::make_shared<const std::vector<std::byte>>(encode(*picture, format, summary));
        summary.seconds_encode = since(filtered);
        summary.encoding = format.encoding;
        summary.width = picture->width();
        summary.height = picture->height();
        summary.components = picture->components();
        summary.byte_size = result.bytes->size();
    } catch (const std::exception& error) {
        result.error = "the filter " + summary.filter + " failed: " + error.what();
    }
    return result;
}

const filter::Planes& Reconstructor::filtered(const frame::FilmTile& film, const view::View& view,
                                              const SceneState& scene) {
    const auto choice = filter::parse_choice(view.filter, filter::catalog());
    if (!choice) throw choice.error();
    filter::resolve_inputs(film, view, nullptr, inputs_);
    instance(*choice, view, scene, inputs_).run(inputs_, choice->values, output_, {arena_, {}});
    return output_.picture;
}

double Reconstructor::calibrate(const view::View& asked, session::PictureEncoding encoding,
                                std::uint32_t width, std::uint32_t height) {
    view::View view = asked;
    view.id = {};  // not a picture of the view
    const Rect rect{0, 0, static_cast<std::int32_t>(width), static_cast<std::int32_t>(height)};
    frame::FilmTile film(rect, {0, 2}, view.channels);
    std::fill(film.counts.begin(), film.counts.end(), 4u);
    std::uint32_t state = 1;
    for (float& value : film.planes) {
        state = state * 1664525u + 1013904223u;
        value = static_cast<float>(state >> 8) * 0x1p-24f;
    }
    const auto started = Clock::now();
    reconstruct({.film = film}, view, {}, {.encoding = encoding, .transform = {}, .view = view.id});
    const double seconds = since(started);
    forget(view.id, ViewId{view.id.value + 1});
    return seconds;
}

}  // namespace tessera::master
