#pragma once

#include <optional>
#include <string>
#include <vector>

#include "client/frame.h"
#include "mediator/picture/custom_view.h"
#include "mediator/picture/film_exr.h"

namespace tessera::tools {

enum class PictureFormat { Exr, Png, Jpeg };

// By the extension; nothing for unsupported formats.
std::optional<PictureFormat> picture_format(const std::string& path);

// Provenance of a film, stored in the file.
struct Origin {
    std::string scene;  // the file's name
    std::string camera;
    std::string film_hash;
    std::vector<std::string> earlier_kinds{};  // of the nodes that rendered the film that it continues
};

// Writes what the result holds to every path: the master's picture where there is one, else the resolved
// radiance, by request.display_transform; an EXR gets the film's channels, too, and its statistics if they are
// to be saved. A file is there in full or not at all. Throws Error{Io}.
void write_pictures(const std::vector<std::string>& paths, const session::ViewRequest& request,
                    const client::ViewResult& result, const Origin& origin, picture::Statistics statistics,
                    const picture::CustomView* custom = nullptr);

// What an EXR of the result shows, if it has a film.
std::vector<picture::Layer> layers_of(const client::ViewResult& result);

// An EXR without a film, a PNG or a JPEG, of linear R, G, B (A).
void write_picture(const std::string& path, const frame::Image& image,
                   const view::DisplayTransform& transform, const picture::CustomView* custom = nullptr);

// A PNG of the relative error of each pixel (mediator/picture/noise_map.h) on a logarithmic scale from 0.01 to 1.
void write_noise_map(const std::string& path, const frame::FilmTile& film);

// The transform of the request with the exposure of the result: the master's where it encoded the picture,
// else measured of the picture that would be written; none if that is black, so that a sequence which fades in
// takes the exposure of its first frame with light. Unchanged if it has an exposure, or if all paths are EXR.
view::DisplayTransform used_transform(const std::vector<std::string>& paths,
                                      const session::ViewRequest& request, const client::ViewResult& result);

}  // namespace tessera::tools
