#include "client/tools/pictures.h"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <filesystem>
#include <map>
#include <set>
#include <span>

#include "client/tools/continued_film.h"
#include "client/tools/formatted.h"
#include "client/tools/view_attributes.h"
#include "mediator/frame/resolve.h"
#include "mediator/picture/atomic_file.h"
#include "mediator/picture/exposure.h"
#include "mediator/picture/heat_map.h"
#include "mediator/picture/mark_tiles.h"
#include "mediator/picture/noise_map.h"
#include "mediator/picture/picture_encoder.h"
#include "mediator/program/command_line.h"

namespace tessera::tools {

namespace {

const char* name(session::Outcome outcome) {
    switch (outcome) {
        case session::Outcome::Complete:
            return "complete";
        case session::Outcome::TimeUp:
            return "time up";
        case session::Outcome::Stopped:
            return "stopped";
        case session::Outcome::NoNodes:
            return "all nodes were gone";
        case session::Outcome::Incomplete:
            return "incomplete";
        case session::Outcome::Failed:
            break;
    }
    return "failed";
}

const char* name(view::PixelFilterKind kind) {
    switch (kind) {
        case view::PixelFilterKind::Box:
            return "box";
        case view::PixelFilterKind::Gaussian:
            return "gaussian";
        case view::PixelFilterKind::BlackmanHarris:
            break;
    }
    return "blackman-harris";
}

// "x y width height samples" of each, separated by commas.
std::string failed_tiles_text(const std::vector<session::FailedTile>& tiles) {
    std::string text;
    for (const session::FailedTile& tile : tiles) {
        const Rect& rect = tile.rect;
        if (!text.empty()) text += ", ";
        for (const std::int32_t value : {rect.x, rect.y, rect.width, rect.height})
            text += std::to_string(value) + " ";
        text += std::to_string(tile.samples);
    }
    return text;
}

void mark_failed_tiles(frame::Image& image, const session::ViewRequest& request,
                       const session::ViewSummary& summary) {
    std::vector<Rect> tiles;
    for (const session::FailedTile& tile : summary.failed_tiles) {
        if (tile.samples == 0) tiles.push_back(tile.rect);
    }
    picture::mark_tiles(image, tiles, request.display_transform.exposure.value_or(0.0), request.view.window.x,
                        request.view.window.y);
}

std::string kinds_of(const client::ViewResult& result, const std::vector<std::string>& earlier) {
    std::set<std::string> kinds;
    for (const session::NodeSummary& node : result.summary.nodes) kinds.insert(node.kind);
    kinds.insert(earlier.begin(), earlier.end());
    std::string text;
    for (const std::string& kind : kinds) text += (text.empty() ? "" : "; ") + kind;
    return text;
}

// Metadata to reproduce the picture, and its sample counts.
std::map<std::string, std::string> provenance(const session::ViewRequest& request,
                                              const client::ViewResult& result, const Origin& origin) {
    const auto [fewest, most] =
        std::minmax_element(result.film()->counts.begin(), result.film()->counts.end());
    std::map<std::string, std::string> attributes = view_attributes(request.view);
    if (result.has_picture()) attributes["tessera.filter"] = result.summary.picture.filter;
    if (result.summary.noise > 0.0) attributes["tessera.noise"] = formatted("%.6g", result.summary.noise);
    if (result.summary.error > 0.0) attributes["tessera.error"] = formatted("%.6g", result.summary.error);
    if (!result.summary.failed_tiles.empty())
        attributes["tessera.failedTiles"] = failed_tiles_text(result.summary.failed_tiles);
    attributes.insert({{"tessera.software", "tessera " + cli::version()},
                       {"tessera.scene", origin.scene},
                       {"tessera.camera", origin.camera},
                       {"tessera.filmHash", origin.film_hash},
                       {"tessera.outcome", name(result.summary.outcome)},
                       {"tessera.kinds", kinds_of(result, origin.earlier_kinds)},
                       {"tessera.nodes", std::to_string(result.summary.nodes.size())},
                       {"tessera.seed", std::to_string(request.view.seed)},
                       {"tessera.maxBounces", std::to_string(request.view.max_bounces)},
                       {"tessera.maxSpecularBounces", std::to_string(request.view.max_specular_bounces)},
                       {"tessera.layers", std::to_string(request.view.layers)},
                       {"tessera.pixelFilter", name(request.view.pixel_filter.kind)},
                       {"tessera.samples", std::to_string(result.summary.samples)},
                       {"tessera.nonfiniteSamples", std::to_string(result.film()->nonfinite_samples)},
                       {"tessera.samplesPerPixelLeast", std::to_string(*fewest)},
                       {"tessera.samplesPerPixelMost", std::to_string(*most)}});
    return attributes;
}

// The unfiltered picture, with alpha if the film has it.
frame::Image unfiltered(const frame::FilmTile& film) {
    frame::Image light = frame::resolve_picture(film);
    if (!film.channels.contains(frame::Channel::Alpha)) return light;
    const frame::Image alpha = frame::resolve(film, frame::Channel::Alpha);
    frame::Image image(light.width, light.height, 4);
    for (std::size_t i = 0; i < image.pixel_count(); ++i) {
        std::copy_n(light.pixel(i).begin(), 3, image.pixel(i).begin());
        image.pixel(i)[3] = alpha.values[i];
    }
    return image;
}

// Throws Error{Unavailable} if the size of the picture does not match its header.
frame::Image interleaved(const client::Frame& picture) {
    frame::Image image(picture.width, picture.height, picture.components);
    if (picture.components < 3 || picture.components > 4 ||
        picture.picture.size() != image.values.size() * sizeof(float)) {
        throw Error(ErrorCode::Unavailable,
                    "the master's picture is damaged: check that master and client are of the same version");
    }
    for (std::uint32_t c = 0; c < image.components; ++c) {
        for (std::size_t i = 0; i < image.pixel_count(); ++i) {
            std::memcpy(&image.values[i * image.components + c],
                        &picture.picture[(c * image.pixel_count() + i) * sizeof(float)], sizeof(float));
        }
    }
    return image;
}

void write_bytes(const std::string& path, std::span<const std::byte> bytes) {
    picture::write_atomically(path,
                              std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

bool is_encoded(const client::ViewResult& result) {
    return result.has_picture() && result.frame.encoding != session::PictureEncoding::Planes;
}

}  // namespace

std::optional<PictureFormat> picture_format(const std::string& path) {
    std::string extension = std::filesystem::path(path).extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
    if (extension == ".exr") return PictureFormat::Exr;
    if (extension == ".png") return PictureFormat::Png;
    if (extension == ".jpg" || extension == ".jpeg") return PictureFormat::Jpeg;
    return std::nullopt;
}

void write_picture(const std::string& path, const frame::Image& image,
                   const view::DisplayTransform& transform, const picture::CustomView* custom) {
    using picture::FileFormat;
    const PictureFormat format = picture_format(path).value_or(PictureFormat::Exr);
    write_bytes(path, picture::encode_picture(image,
                                              format == PictureFormat::Png    ? FileFormat::Png
                                              : format == PictureFormat::Jpeg ? FileFormat::Jpeg
                                                                              : FileFormat::Exr,
                                              transform, custom));
}

void write_noise_map(const std::string& path, const frame::FilmTile& film) {
    const frame::Image image =
        picture::heat_map(picture::noise_of_pixels(film), static_cast<std::uint32_t>(film.rect.width),
                          static_cast<std::uint32_t>(film.rect.height), 0.01f, 1.0f);
    write_picture(path, image, {view::ViewTransform::Linear, 0.0});
}

view::DisplayTransform used_transform(const std::vector<std::string>& paths,
                                      const session::ViewRequest& request, const client::ViewResult& result) {
    const bool none_shown = std::all_of(paths.begin(), paths.end(), [](const std::string& path) {
        return picture_format(path) == PictureFormat::Exr;
    });
    if (none_shown || request.display_transform.exposure) return request.display_transform;
    if (is_encoded(result)) return result.summary.picture.display_transform;
    view::DisplayTransform transform = request.display_transform;
    transform.exposure = picture::measured_exposure(result.has_picture() ? interleaved(result.frame)
                                                                         : unfiltered(*result.film()));
    return transform;
}

std::vector<picture::Layer> layers_of(const client::ViewResult& result) {
    if (!result.film()) return {};
    std::optional<frame::Image> filtered;
    if (result.has_picture() && !is_encoded(result)) filtered = interleaved(result.frame);
    return picture::film_layers(*result.film(), filtered);
}

void write_pictures(const std::vector<std::string>& paths, const session::ViewRequest& request,
                    const client::ViewResult& result, const Origin& origin, picture::Statistics statistics,
                    const picture::CustomView* custom) {
    std::optional<frame::Image> filtered;
    if (result.has_picture() && !is_encoded(result)) filtered = interleaved(result.frame);
    for (const std::string& path : paths) {
        if (is_encoded(result)) {
            write_bytes(path, result.frame.picture);  // encoded by the master
        } else if (picture_format(path) == PictureFormat::Exr) {
            picture::FilmFile file{.width = request.view.width,
                                   .height = request.view.height,
                                   .film = *result.film(),
                                   .attributes = provenance(request, result, origin)};
            if (statistics == picture::Statistics::Include && result.frame.film_state)
                add_continuation(file, request.view, result.summary, *result.frame.film_state);
            picture::write_film_exr(path, file, filtered, statistics);
        } else {
            frame::Image image = filtered ? *filtered : unfiltered(*result.film());
            mark_failed_tiles(image, request, result.summary);
            write_picture(path, image, request.display_transform, custom);
        }
    }
}

}  // namespace tessera::tools
