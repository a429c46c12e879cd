#include "client/tools/continued_film.h"

#include <algorithm>
#include <cstdio>
#include <optional>

#include "client/tools/view_attributes.h"
#include "mediator/frame/render_revision.h"
#include "mediator/wire/envelope.h"

namespace tessera::tools {

namespace {

constexpr const char* View = "tessera.view";
constexpr const char* SceneHash = "tessera.sceneHash";
constexpr const char* Revision = "tessera.renderRevision";
constexpr const char* Kinds = "tessera.kinds";

std::string hex(std::span<const std::byte> bytes) {
    std::string text;
    for (const std::byte value : bytes) {
        char digits[3];
        std::snprintf(digits, sizeof digits, "%02x", static_cast<unsigned>(value));
        text += digits;
    }
    return text;
}

std::optional<std::vector<std::byte>> from_hex(const std::string& text) {
    const auto digit = [](char c) {
        return c >= '0' && c <= '9' ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
    };
    std::vector<std::byte> bytes;
    for (std::size_t i = 0; i + 1 < text.size(); i += 2) {
        const int high = digit(text[i]), low = digit(text[i + 1]);
        if (high < 0 || low < 0) return std::nullopt;
        bytes.push_back(static_cast<std::byte>(16 * high + low));
    }
    return text.size() % 2 == 0 ? std::optional(bytes) : std::nullopt;
}

// As a request for it, since that has an encoding.
std::string encoded(const view::View& view) {
    return hex(wire::encode(wire::ControlMessage(wire::RequestView{.wanted = {.name = {}, .view = view}})));
}

std::optional<view::View> decoded(const std::string& text) {
    const auto bytes = from_hex(text);
    if (!bytes) return std::nullopt;
    auto message = wire::decode_control(*bytes);
    auto* request = message ? std::get_if<wire::RequestView>(&*message) : nullptr;
    return request != nullptr ? std::optional(std::move(request->wanted.view)) : std::nullopt;
}

std::string hash_text(const Hash128& hash) {
    char text[33];
    std::snprintf(text, sizeof text, "%016llx%016llx", static_cast<unsigned long long>(hash.high),
                  static_cast<unsigned long long>(hash.low));
    return text;
}

}  // namespace

void add_continuation(picture::FilmFile& file, const view::View& view, const session::ViewSummary& summary,
                      frame::FilmState state) {
    view::View bare = view;
    bare.id = {};
    bare.revision = 1;
    bare.filter.clear();
    bare.channels = file.film.channels;
    file.attributes[View] = encoded(bare);
    file.attributes[SceneHash] = hash_text(summary.scene_hash);
    file.attributes[Revision] = std::to_string(frame::RenderRevision);
    state.steps = summary.steps;
    file.state = std::move(state);
}

ContinuedFilm read_continued_film(const std::string& path) {
    const auto fail = [&](const std::string& what) {
        throw Error(ErrorCode::InvalidInput, "film '" + path + "': " + what);
    };
    picture::FilmFile file = picture::read_film_exr(path, picture::State::Included);
    const auto attribute = [&](const char* name) {
        const auto found = file.attributes.find(name);
        return found == file.attributes.end() ? std::string() : found->second;
    };
    if (!file.state || attribute(View).empty())
        fail(
            "it has what filters need, but not what goes on: it is of an older build, or of tessera filter; "
            "render it again with --save-statistics");
    ContinuedFilm continued{.path = path, .film = {}, .view = {}, .kinds = attribute(Kinds)};
    const auto view = decoded(attribute(View));
    if (!view) fail("its attribute 'tessera.view' is damaged: render it again");
    continued.view = *view;
    if (continued.view.window != file.film.rect || continued.view.channels != file.film.channels)
        fail("its view and its film do not fit: the file was changed; render it again");
    const std::string scene = attribute(SceneHash);
    client::EarlierFilm& film = continued.film;
    unsigned long long high = 0, low = 0;
    if (scene.size() != 32 || std::sscanf(scene.c_str(), "%16llx%16llx", &high, &low) != 2)
        fail("its attribute 'tessera.sceneHash' is damaged: render it again");
    film.scene_hash = {high, low};
    film.render_revision = static_cast<std::uint32_t>(std::strtoul(attribute(Revision).c_str(), nullptr, 10));
    film.kind = continued.kinds;
    film.film = std::move(*file.state);
    for (const frame::FilmTile& block : film.film.blocks) {
        const Rect& rect = block.rect;
        continued.tile = std::max({continued.tile, static_cast<std::uint32_t>(rect.width),
                                   static_cast<std::uint32_t>(rect.height)});
    }
    const auto [least, most] = std::ranges::minmax(file.film.counts);
    continued.least_samples = least;
    continued.most_samples = most;
    return continued;
}

std::vector<std::string> listed_kinds(const std::string& kinds) {
    std::vector<std::string> list;
    for (std::size_t from = 0; from < kinds.size();) {
        const std::size_t to = std::min(kinds.find("; ", from), kinds.size());
        list.push_back(kinds.substr(from, to - from));
        from = to + 2;
    }
    return list;
}

std::string contradicting_option(const ViewOptions& given, const ViewPlan& plan, const view::View& film) {
    const ViewOptions standard;
    const view::View& wanted = plan.view;
    struct Choice {
        const char* option;
        bool is_given, is_same;
    };
    for (const Choice& choice : {
             Choice{"--size", given.size != standard.size,
                    wanted.width == film.width && wanted.height == film.height},
             {"--crop", given.crop.has_value(), wanted.window == film.window},
             {"--seed", given.seed != standard.seed, wanted.seed == film.seed},
             {"--bounces", given.bounces != standard.bounces, wanted.max_bounces == film.max_bounces},
             {"--specular-bounces", given.specular_bounces != standard.specular_bounces,
              wanted.max_specular_bounces == film.max_specular_bounces},
             {"--clamp", given.clamp.has_value(), wanted.clamp_indirect == film.clamp_indirect},
             {"--sky-sampling", given.sky_sampling != standard.sky_sampling,
              wanted.sky_cells_from == film.sky_cells_from},
             {"--pixel-filter", given.pixel_filter != standard.pixel_filter,
              wanted.pixel_filter == film.pixel_filter},
             {"--renderer", given.renderer != standard.renderer, wanted.renderer == film.renderer},
             {"--path-class", given.path_class != standard.path_class, wanted.path_class == film.path_class},
             {"--feature-rule", given.feature_rule != standard.feature_rule,
              wanted.feature_rule == film.feature_rule},
             {"--layers", given.layers.has_value(), wanted.layers == film.layers},
             {"--transparent", given.transparent,
              wanted.transparent_background == film.transparent_background},
         }) {
        if (choice.is_given && !choice.is_same) return choice.option;
    }
    return {};
}

}  // namespace tessera::tools
