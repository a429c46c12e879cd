#include "mediator/backend/sky_cells.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <span>

#include "mediator/base/parallel.h"
#include "mediator/shading/area_lights.h"
#include "mediator/shading/environment.h"
#include "mediator/shading/sampler.h"
#include "mediator/shading/sky_cells.h"

namespace tessera::backend {

namespace {

using shading::SkyCell;
using shading::SkyNode;
using shading::SkyTiles;
using std::numbers::pi;

constexpr std::uint64_t Paths = 1 << 15, PathsPerTask = 256, TrialPaths = 1 << 11;
// Far from those of any film.
constexpr std::uint64_t FirstSample = std::uint64_t{1} << 63;
constexpr std::size_t PlacesPerCell = 64;
constexpr std::uint32_t RaysPerTile = 4, MapRays = 256, SunRays = 64;
// Cells pay where less of the sky is seen.
constexpr double MostVisible = 0.5;
// At least this much of the samples for each of tiles and map, if they have any light.
constexpr double LeastChance = 0.05;
// Share of a tile's light that its four neighbours get: rays may miss the edge of a window.
constexpr double Spill = 0.1;

using Tiles = std::array<double, SkyTiles>;

glm::vec2 pair_of(std::uint32_t number, std::uint32_t seed) {
    return shading::first_pair(shading::sample_set({number, seed}, 0));
}

// The sky in two parts: what the samples of its map find, which is its luminance above its mean, and the rest, by tiles.
struct SplitSky {
    Tiles base{};  // mean luminance of each tile, without the excess
    double base_mean = 0.0;

    SplitSky(const shading::Scene& scene, const SkyMeans& means) : scene_(scene), means_(means) {
        constexpr std::uint32_t Side = 8;
        for (std::uint32_t tile = 0; tile < SkyTiles; ++tile) {
            for (std::uint32_t i = 0; i < Side * Side; ++i) {
                const glm::vec2 u = (glm::vec2(float(i % Side), float(i / Side)) + 0.5f) / float(Side);
                base[tile] +=
                    std::min(luminance(shading::direction_in_tile(tile, u)), means.luminance) / (Side * Side);
            }
            base_mean += base[tile] / SkyTiles;
        }
    }

    bool has_excess() const { return means_.excess > 0.0; }
    double excess_mean() const { return means_.excess; }
    // Of a direction by the map, times the solid angle that it stands for, over the sphere's.
    double excess(const glm::vec3& direction) const {
        const shading::Sky sky = shading::sky_at(scene_, direction);
        if (!(sky.pdf > 0.0f)) return 0.0;
        return std::max(luminance(direction) - means_.luminance, 0.0) / (double(sky.pdf) * 4.0 * pi);
    }
    glm::vec3 direction_by_map(const glm::vec2& u) const { return shading::sample_sky(scene_, u); }

  private:
    double luminance(const glm::vec3& direction) const {
        const auto found = double(shading::luminance(shading::sky_at(scene_, direction).radiance));
        return std::isfinite(found) ? std::max(found, 0.0) : 0.0;
    }

    const shading::Scene& scene_;
    const SkyMeans means_;
};

// The directional lights that the view sees; their motion is ignored, which costs noise, never bias.
class Suns {
  public:
    Suns(const shading::Scene& scene, const shading::View& view) {
        for (std::uint32_t i = scene.tree_light_count; i < scene.light_count; ++i) {
            const shading::LightSource& light = scene.lights.items[i];
            if (light.kind != shading::LightDirectional || !(light.irradiance > 0.0f)) continue;
            if ((light.layers & view.layers) != 0u) suns_.push_back(light);
        }
    }

    bool empty() const { return suns_.empty(); }
    double irradiance() const {
        return std::accumulate(suns_.begin(), suns_.end(), 0.0,
                               [](double sum, const auto& sun) { return sum + double(sun.irradiance); });
    }
    // Towards a sun that is chosen by its irradiance.
    glm::vec3 direction(float u, const glm::vec2& in_disk) const {
        double left = double(u) * irradiance();
        std::size_t chosen = 0;
        while (chosen + 1 < suns_.size() && (left -= double(suns_[chosen].irradiance)) >= 0.0) ++chosen;
        return shading::sample_cone(-suns_[chosen].direction, suns_[chosen].one_minus_cos_half_angle,
                                    in_disk);
    }

  private:
    std::vector<shading::LightSource> suns_;
};

// What a cell learns.
struct CellLight {
    Tiles tiles{};         // base luminance times cosine that arrives, mean over the tile
    double base = 0.0;     // mean of the tiles
    double excess = 0.0;   // the same of the excess
    double visible = 0.0;  // light that arrives, found by all rays
    double all = 0.0;      // if nothing were hidden
    double visible_suns = 0.0, all_suns = 0.0;  // the same of directional lights, in rays times cosine
};

// Rays from places of a cell.
class CellRays {
  public:
    CellRays(const SkyRays& rays, std::span<const SkyPlace> places, std::uint32_t cell)
        : rays_(rays), places_(places), seed_(shading::hash_u32(cell)) {}

    glm::vec2 pair() { return pair_of(number_++, seed_); }
    // What arrives at one of the places of light of this size: times the cosine; 0 where it is hidden. Adds it to
    // `visible`, and to `all` as if nothing were hidden.
    double arriving(const glm::vec3& direction, double size, double& visible, double& all) {
        const SkyPlace& place =
            places_[std::min(static_cast<std::size_t>(pair().x * float(places_.size())), places_.size() - 1)];
        const bool is_two_sided = place.normal == glm::vec3(0.0f);
        const double cosine = is_two_sided ? 0.5 : double(glm::dot(place.normal, direction));
        if (!(cosine > 0.0) || !(size > 0.0)) return 0.0;
        all += size * cosine;
        if (!rays_.sees_sky(place, direction, number_)) return 0.0;
        visible += size * cosine;
        return size * cosine;
    }

  private:
    const SkyRays& rays_;
    std::span<const SkyPlace> places_;
    std::uint32_t seed_;
    std::uint32_t number_ = 0;
};

void measure_sky(const SplitSky& sky, CellRays& rays, CellLight& light) {
    const auto arriving = [&](const glm::vec3& direction, double luminance) {
        return rays.arriving(direction, luminance, light.visible, light.all);
    };
    for (std::uint32_t tile = 0; tile < SkyTiles; ++tile) {
        if (!(sky.base[tile] > 0.0)) continue;
        for (std::uint32_t i = 0; i < RaysPerTile; ++i)
            light.tiles[tile] +=
                arriving(shading::direction_in_tile(tile, rays.pair()), sky.base[tile]) / RaysPerTile;
        light.base += light.tiles[tile] / SkyTiles;
    }
    if (!sky.has_excess()) return;
    for (std::uint32_t i = 0; i < MapRays; ++i) {
        const glm::vec3 direction = sky.direction_by_map(rays.pair());
        light.excess += arriving(direction, sky.excess(direction)) / MapRays;
    }
    // As if one more ray had found the mean (rule of succession): a sun that shines on less of the cell than the rays
    // can tell keeps a chance. 1/4: the mean cosine over the sphere, where it is negative 0.
    light.excess += 0.25 * sky.excess_mean() / MapRays;
}

struct InfiniteLights {
    std::optional<SplitSky> sky;
    Suns suns;
};

CellLight measure_cell(const InfiniteLights& lights, const SkyRays& scene_rays,
                       std::span<const SkyPlace> places, std::uint32_t cell) {
    CellRays rays(scene_rays, places, cell);
    CellLight light;
    if (lights.sky) measure_sky(*lights.sky, rays, light);
    for (std::uint32_t i = 0; i < SunRays && !lights.suns.empty(); ++i) {
        const float choice = rays.pair().x;
        rays.arriving(lights.suns.direction(choice, rays.pair()), 1.0, light.visible_suns, light.all_suns);
    }
    return light;
}

// Splits the places by the median along the longest side, until PlacesPerCell are left.
struct CellTree {
    std::vector<SkyNode> nodes =
        std::vector<SkyNode>(shading::SkyFaces, {0.0f, shading::SkyLeaf, shading::NoSkyCell});
    std::vector<std::span<const SkyPlace>> cells;

    void split(std::uint32_t node, std::span<SkyPlace> places, std::uint32_t depth) {
        if (places.empty()) return;
        glm::vec3 low = places.front().position, high = low;
        for (const SkyPlace& place : places) {
            low = glm::min(low, place.position);
            high = glm::max(high, place.position);
        }
        const glm::vec3 size = high - low;
        const int axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
        if (places.size() >= 2 * PlacesPerCell && depth + 1 < shading::MaxSkyDepth && size[axis] > 0.0f) {
            // A stable order, so that cells are the same with every standard library.
            std::stable_sort(places.begin(), places.end(), [&](const SkyPlace& a, const SkyPlace& b) {
                return a.position[axis] < b.position[axis];
            });
            const float middle = places[places.size() / 2].position[axis];
            const auto second =
                std::partition_point(places.begin(), places.end(),
                                     [&](const SkyPlace& place) { return place.position[axis] < middle; });
            if (second != places.begin()) {
                const auto child = static_cast<std::uint32_t>(nodes.size());
                nodes.resize(nodes.size() + 2, {0.0f, shading::SkyLeaf, shading::NoSkyCell});
                nodes[node] = {middle, static_cast<std::uint32_t>(axis), child};
                split(child, {places.begin(), second}, depth + 1);
                split(child + 1, {second, places.end()}, depth + 1);
                return;
            }
        }
        nodes[node] = {0.0f, shading::SkyLeaf, static_cast<std::uint32_t>(cells.size())};
        cells.push_back(places);
    }
};

void add_cell(SkyCells& result, const CellLight& light, double irradiance_unit) {
    Tiles spread{};
    for (std::uint32_t tile = 0; tile < SkyTiles; ++tile) {
        const std::uint32_t x = tile % shading::SkyColumns, y = tile / shading::SkyColumns,
                            row = y * shading::SkyColumns;
        spread[tile] = light.tiles[tile] +
                       Spill * (light.tiles[row + (x + 1) % shading::SkyColumns] +
                                light.tiles[row + (x + shading::SkyColumns - 1) % shading::SkyColumns]);
        if (y > 0) spread[tile] += Spill * light.tiles[tile - shading::SkyColumns];
        if (y + 1 < shading::SkyRows) spread[tile] += Spill * light.tiles[tile + shading::SkyColumns];
    }
    const double sum = std::accumulate(spread.begin(), spread.end(), 0.0), both = light.base + light.excess;
    SkyCell cell{
        .cdf = static_cast<std::uint32_t>(result.cdfs.size()), .tile_chance = 0.0f, .irradiance = 0.0f};
    // As if two more rays that face the suns head on had found one of them (rule of succession).
    cell.suns = static_cast<float>((light.visible_suns + 1.0) / (light.all_suns + 2.0));
    double part = 0.0;
    for (std::uint32_t tile = 0; tile < SkyTiles; ++tile) {
        part += sum > 0.0 ? spread[tile] / sum : 1.0 / SkyTiles;
        result.cdfs.push_back(static_cast<float>(std::min(part, 1.0)));
    }
    result.cdfs.back() = 1.0f;
    if (!(light.excess > 0.0)) {
        cell.tile_chance = 1.0f;
    } else if (light.base > 0.0) {
        cell.tile_chance = static_cast<float>(LeastChance + (1.0 - 2.0 * LeastChance) * (light.base / both));
    }
    // Infinite lights count as if they faced the receiver; a sky of luminance 1 has the mean cosine 1/4.
    cell.irradiance = static_cast<float>(4.0 * both * irradiance_unit);
    result.cells.push_back(cell);
}

std::vector<SkyPlace> trace_places(const shading::View& view, const SkyRays& rays, std::uint64_t paths,
                                   tbb::task_arena& arena, const std::stop_token& stop) {
    std::vector<std::vector<SkyPlace>> found(paths / PathsPerTask);
    parallel_for(arena, found.size(), [&](std::size_t task) {
        if (stop.stop_requested()) return;
        for (std::uint64_t i = task * PathsPerTask; i < (task + 1) * PathsPerTask; ++i) {
            const glm::vec2 place = pair_of(static_cast<std::uint32_t>(i), 0u);
            const auto x = std::min(static_cast<std::uint32_t>(place.x * float(view.width)), view.width - 1);
            const auto y =
                std::min(static_cast<std::uint32_t>(place.y * float(view.height)), view.height - 1);
            rays.trace_path(x, y, FirstSample + i, found[task]);
        }
    });
    std::vector<SkyPlace> places;
    for (const std::vector<SkyPlace>& part : found) places.insert(places.end(), part.begin(), part.end());
    return places;
}

}  // namespace

void SkyCells::use_in(shading::View& view, std::uint32_t first_sample) const {
    if (empty()) return;
    view.sky_nodes.items = nodes.data();
    view.sky_cells.items = cells.data();
    view.sky_cdfs.items = cdfs.data();
    view.sky_cells_from = first_sample;
}

std::optional<SkyCells> make_sky_cells(const SceneTables& tables, const shading::View& view,
                                       const SkyRays& rays, std::uint32_t threads,
                                       const std::stop_token& stop) {
    SkyCells result;
    tbb::task_arena arena(threads == 0 ? tbb::task_arena::automatic : static_cast<int>(threads));
    const shading::Scene scene = on_host(tables);
    InfiniteLights infinite{.suns = Suns(scene, view)};
    if (scene.environment_light >= 0) infinite.sky.emplace(scene, tables.sky);
    const bool has_choice =
        scene.light_count - scene.tree_light_count + (scene.tree_light_count > 0 ? 1 : 0) > 1;
    if (!infinite.sky && (infinite.suns.empty() || !has_choice)) return result;
    // A first look at all places as if they were one cell.
    const std::vector<SkyPlace> some = trace_places(view, rays, TrialPaths, arena, stop);
    if (stop.stop_requested()) return std::nullopt;
    if (some.empty()) return result;
    const CellLight together = measure_cell(infinite, rays, some, shading::NoSkyCell);
    if (together.all > 0.0) result.visible = together.visible / together.all;
    if (together.all_suns > 0.0) result.visible_suns = together.visible_suns / together.all_suns;
    if (result.visible > MostVisible && !(has_choice && result.visible_suns <= MostVisible)) return result;

    std::array<std::vector<SkyPlace>, shading::SkyFaces> faces;
    for (const SkyPlace& place : trace_places(view, rays, Paths, arena, stop))
        faces[shading::sky_face_of(place.normal)].push_back(place);
    CellTree tree;
    for (std::uint32_t face = 0; face < shading::SkyFaces; ++face) tree.split(face, faces[face], 0);
    std::vector<CellLight> lights(tree.cells.size());
    parallel_for(arena, lights.size(), [&](std::size_t cell) {
        if (!stop.stop_requested())
            lights[cell] = measure_cell(infinite, rays, tree.cells[cell], static_cast<std::uint32_t>(cell));
    });
    if (stop.stop_requested()) return std::nullopt;
    result.nodes = std::move(tree.nodes);
    for (const CellLight& light : lights) add_cell(result, light, double(scene.environment.irradiance_unit));
    return result;
}

}  // namespace tessera::backend
