#include "tests/bench/filters/references.h"

#include <cstdio>
#include <cstring>

#include "mediator/frame/resolve.h"
#include "mediator/picture/film_exr.h"

namespace tessera::tools::bench {

namespace {

constexpr const char* KeyAttribute = "tessera.bench.key";
constexpr const char* HashAttribute = "tessera.bench.film";

// Hash of a small film of the scene: another renderer gives another hash.
std::string fingerprint(const ReferenceRequest& request, const Sampler& sampler) {
    view::View small = request.view;
    small.width = 32;
    small.height = 18;
    small.window = {0, 0, 32, 18};
    small.seed = 0;
    small.channels = {frame::Channel::Radiance};
    GrowingFilm film = sampler.film(small);
    sampler.grow(film, 4, {});
    return to_hex(frame::film_hash(film.whole()));
}

std::string key_of(const ReferenceRequest& request, const std::string& fingerprint, std::uint64_t seed) {
    const view::CameraPose& camera = request.view.camera;
    Blake2b hash;
    const auto add_text = [&](const std::string& text) {
        const std::uint64_t size = text.size();
        hash.update(std::as_bytes(std::span(&size, 1)));
        hash.update(std::as_bytes(std::span(text)));
    };
    const auto add = [&](const auto& value) { hash.update(std::as_bytes(std::span(&value, 1))); };
    add_text(request.content);
    add_text(fingerprint);
    add(camera.world_from_camera);
    add(std::array{camera.left, camera.right, camera.bottom, camera.top});
    add(std::array<std::uint64_t, 5>{request.view.width, request.view.height, request.view.max_bounces,
                                     request.spp, seed});
    return to_hex(hash.finish());
}

// Renders in steps, to report progress.
std::optional<frame::FilmTile> render(const ReferenceRequest& request, std::uint64_t seed,
                                      const Sampler& sampler, const ReferenceProgress& progress,
                                      const std::stop_token& stop) {
    view::View view = request.view;
    view.seed = seed;
    view.channels = {frame::Channel::Radiance};
    GrowingFilm film = sampler.film(view);
    const std::uint64_t step = std::max<std::uint64_t>(1, request.spp / 16);
    while (film.spp() < request.spp) {
        if (!sampler.grow(film, std::min(request.spp, film.spp() + step), stop)) return std::nullopt;
        progress.say(request.scene + ": reference " + std::to_string(view.width) + "x" +
                     std::to_string(view.height) + ", " + std::to_string(film.spp()) + " of " +
                     std::to_string(request.spp) + " spp");
    }
    return film.whole();
}

}  // namespace

Expected<frame::FilmTile> ReferenceCache::load(const std::string& name, const std::string& key) const {
    const std::string file = path(name).string();
    if (!std::filesystem::exists(file)) return failure(ErrorCode::NotFound, "file '" + file + "' not found");
    try {
        picture::FilmFile read = picture::read_film_exr(file);
        if (read.attributes[KeyAttribute] != key) {
            return failure(ErrorCode::NotFound, "'" + file + "' is a reference with another key");
        }
        if (read.attributes[HashAttribute] != to_hex(frame::film_hash(read.film))) {
            return failure(ErrorCode::InvalidInput,
                           "'" + file + "' is damaged: its pixels do not match the stored hash");
        }
        return std::move(read.film);
    } catch (const Error& error) {
        return failure(ErrorCode::InvalidInput, error.what());
    }
}

void ReferenceCache::store(const std::string& name, const std::string& key,
                           const frame::FilmTile& film) const {
    std::error_code ignored;  // the writer reports errors of the folder
    std::filesystem::create_directories(folder_, ignored);
    picture::FilmFile file{
        static_cast<std::uint32_t>(film.rect.width), static_cast<std::uint32_t>(film.rect.height), film, {}};
    file.attributes[KeyAttribute] = key;
    file.attributes[HashAttribute] = to_hex(frame::film_hash(film));
    picture::write_film_exr(path(name).string(), file, {}, picture::Statistics::Include);
}

std::optional<ReferencePair> references(const ReferenceRequest& request, const Sampler& sampler,
                                        const ReferenceCache& cache, const ReferenceProgress& progress,
                                        const std::stop_token& stop) {
    const std::string bits = fingerprint(request, sampler);
    std::array<frame::Image, 2> images;
    for (std::size_t i = 0; i < images.size(); ++i) {
        const std::uint64_t seed = ReferenceSeeds[i];
        const std::string key = key_of(request, bits, seed);
        const std::string name = request.scene + "-" + std::to_string(request.view.width) + "x" +
                                 std::to_string(request.view.height) + "-" + std::to_string(request.spp) +
                                 "spp-" + std::to_string(seed) + "-" + key.substr(0, 8);
        Expected<frame::FilmTile> film = cache.load(name, key);
        if (!film) {
            if (film.error().code() == ErrorCode::InvalidInput) {
                progress.warn(std::string(film.error().what()) + "; it is rendered again");
            }
            auto rendered = render(request, seed, sampler, progress, stop);
            if (!rendered) return std::nullopt;
            cache.store(name, key, *rendered);
            film = std::move(*rendered);
        }
        images[i] = frame::resolve(*film, frame::Channel::Radiance);
    }
    return ReferencePair(std::move(images[0]), std::move(images[1]));
}

}  // namespace tessera::tools::bench
