#include "client/tools/pictures.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>
#include <set>

#include "client/cli/cli.h"
#include "mediator/frame/resolve.h"
#include "mediator/picture/exr_writer.h"
#include "mediator/picture/png_writer.h"
#include "mediator/picture/tone_map.h"

namespace tessera::tools {

namespace {

const char* name(client::Outcome outcome) {
    switch (outcome) {
        case client::Outcome::Complete:
            return "complete";
        case client::Outcome::TimeUp:
            return "time up";
        case client::Outcome::Stopped:
            return "stopped";
        case client::Outcome::NoNodes:
            return "all nodes were gone";
        case client::Outcome::Failed:
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

std::string kinds_of(const client::JobResult& result) {
    std::set<std::string> kinds;
    for (const client::NodeShare& node : result.nodes) kinds.insert(node.kind);
    std::string text;
    for (const std::string& kind : kinds) text += (text.empty() ? "" : "; ") + kind;
    return text;
}

// Enough to make the picture again, and to tell how much of it is there.
std::map<std::string, std::string> provenance(const client::JobRequest& request,
                                              const client::JobResult& result, const Origin& origin) {
    const auto [fewest, most] = std::minmax_element(result.film->counts.begin(), result.film->counts.end());
    return {{"tessera.software", "tessera " + cli::version()},
            {"tessera.scene", origin.scene},
            {"tessera.camera", origin.camera},
            {"tessera.filmHash", origin.film_hash},
            {"tessera.outcome", name(result.outcome)},
            {"tessera.kinds", kinds_of(result)},
            {"tessera.nodes", std::to_string(result.nodes.size())},
            {"tessera.seed", std::to_string(request.view.seed)},
            {"tessera.maxBounces", std::to_string(request.view.max_bounces)},
            {"tessera.pixelFilter", name(request.view.pixel_filter.kind)},
            {"tessera.samples", std::to_string(result.samples)},
            {"tessera.nonfiniteSamples", std::to_string(result.film->nonfinite_samples)},
            {"tessera.samplesPerPixelLeast", std::to_string(*fewest)},
            {"tessera.samplesPerPixelMost", std::to_string(*most)}};
}

void write_png(const std::string& path, const frame::FilmTile& film) {
    const frame::Image image = frame::resolve(film, frame::Channel::Radiance);
    picture::write_png(path, image.width, image.height, picture::tone_map(image));
}

}  // namespace

std::optional<PictureFormat> picture_format(const std::string& path) {
    std::string extension = std::filesystem::path(path).extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
    if (extension == ".exr") return PictureFormat::Exr;
    if (extension == ".png") return PictureFormat::Png;
    return std::nullopt;
}

void write_pictures(const std::vector<std::string>& paths, const client::JobRequest& request,
                    const client::JobResult& result, const Origin& origin) {
    const auto attributes = provenance(request, result, origin);
    for (const std::string& path : paths) {
        if (picture_format(path) == PictureFormat::Png) {
            write_png(path, *result.film);
        } else {
            picture::write_film_exr(path, request.view.width, request.view.height, *result.film, attributes);
        }
    }
}

}  // namespace tessera::tools
