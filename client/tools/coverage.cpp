#include "client/tools/coverage.h"

#include <algorithm>
#include <bit>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>

#include "mediator/base/old_names.h"

namespace tessera::tools {

namespace {

double fraction(std::uint64_t samples, const Coverage& coverage) {
    return coverage.samples == 0 ? 0.0 : static_cast<double>(samples) / static_cast<double>(coverage.samples);
}

double pixels(std::uint64_t samples, std::uint32_t of_pixel) {
    return static_cast<double>(samples) / static_cast<double>(of_pixel);
}

}  // namespace

SampleGrid sample_grid(std::uint32_t samples) {
    SampleGrid grid{samples, 1};
    for (std::uint32_t down = 2; down * down <= samples; ++down) {
        if (samples % down == 0) grid = {samples / down, down};
    }
    return grid;
}

void spread(view::View& view, SampleGrid grid) {
    const auto across = static_cast<std::int32_t>(grid.across), down = static_cast<std::int32_t>(grid.down);
    view.width *= grid.across;
    view.height *= grid.down;
    view.window = {view.window.x * across, view.window.y * down, view.window.width * across,
                   view.window.height * down};
    view.pixel_filter = {};
}

frame::Image gather(const frame::Image& image, SampleGrid grid) {
    frame::Image means(image.width / grid.across, image.height / grid.down, image.components);
    const float weight = 1.0f / static_cast<float>(grid.count());
    for (std::uint32_t y = 0; y < means.height * grid.down; ++y) {
        for (std::uint32_t x = 0; x < means.width * grid.across; ++x) {
            const auto from = image.pixel(std::size_t{y} * image.width + x);
            const auto to = means.pixel(std::size_t{y / grid.down} * means.width + x / grid.across);
            for (std::uint32_t k = 0; k < image.components; ++k) to[k] += weight * from[k];
        }
    }
    return means;
}

Coverage count_coverage(const frame::FilmTile& film, const std::vector<scene::Create>& scene) {
    std::map<std::uint32_t, std::uint64_t> seen;
    const auto ids = film.plane(film.channels.first_plane(frame::Channel::ObjectIndex) + 1);
    Coverage coverage;
    for (std::size_t i = 0; i < ids.size(); ++i) {
        if (film.counts[i] == 0) continue;
        ++coverage.samples;
        ++seen[std::bit_cast<std::uint32_t>(ids[i])];
    }
    for (const scene::Create& create : scene) {
        const auto* geometry = std::get_if<scene::Geometry>(&create.object);
        if (geometry == nullptr) continue;
        const auto found = seen.find(static_cast<std::uint32_t>(create.id.value));
        if (found == seen.end()) {
            ++coverage.unseen;
            continue;
        }
        coverage.objects.push_back({create.id, geometry->name, found->second});
    }
    if (const auto nothing = seen.find(0); nothing != seen.end()) coverage.background = nothing->second;
    std::sort(coverage.objects.begin(), coverage.objects.end(),
              [](const CoveredObject& a, const CoveredObject& b) {
                  return a.samples != b.samples ? a.samples > b.samples : a.id < b.id;
              });
    return coverage;
}

std::string as_json(const Coverage& coverage, std::uint32_t samples) {
    using Json = nlohmann::ordered_json;
    const auto amount = [&](Json object, std::uint64_t seen) {
        object["samples"] = seen;
        object["pixels"] = pixels(seen, samples);
        object["fraction"] = fraction(seen, coverage);
        object[std::string(*old_name("key", "fraction"))] = object["fraction"];
        return object;
    };
    Json objects = Json::array();
    for (const CoveredObject& object : coverage.objects)
        objects.push_back(amount({{"id", object.id.value}, {"name", object.name}}, object.samples));
    return Json{{"samples", coverage.samples},
                {"spp", samples},
                {"objects", objects},
                {"background", amount(Json::object(), coverage.background)},
                {"unseen", coverage.unseen}}
        .dump(2);
}

std::string as_text(const Coverage& coverage, std::uint32_t samples) {
    std::string text = "fraction      pixels        id  name";
    const auto line = [&](std::uint64_t seen, const std::string& id, const std::string& name) {
        char buffer[64];
        std::snprintf(buffer, sizeof buffer, "\n%6.2f %% %11.1f %9s  ", 100.0 * fraction(seen, coverage),
                      pixels(seen, samples), id.c_str());
        text += buffer + name;
    };
    for (const CoveredObject& object : coverage.objects)
        line(object.samples, std::to_string(object.id.value), object.name);
    line(coverage.background, "", "(background)");
    if (coverage.unseen > 0)
        text += "\nnot seen: " + std::to_string(coverage.unseen) +
                (coverage.unseen == 1 ? " object" : " objects");
    return text;
}

}  // namespace tessera::tools
