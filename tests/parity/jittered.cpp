#include "tests/parity/jittered.h"

#include <cmath>
#include <limits>

#include "backends/embree/context.h"
#include "mediator/backend/tables/view_record.h"
#include "mediator/base/random.h"
#include "mediator/frame/merge.h"
#include "mediator/shading/sample_values.h"
#include "mediator/shading/trace.h"

namespace tessera::test {

namespace {

struct JitteredContext : embree::Context {};

class Jitter {
  public:
    // `seed`: of the ray, so that a sample stays a pure function.
    Jitter(std::uint32_t seed, const glm::vec3& origin)
        : random_(seed, shading::float_bits(origin.x) ^ shading::float_bits(origin.y)) {}

    float operator()(float value) {
        const std::uint64_t choice = random_.below(3);
        constexpr float Infinity = std::numeric_limits<float>::infinity();
        return choice == 0 ? value : std::nextafter(value, choice == 1 ? Infinity : -Infinity);
    }
    glm::vec3 operator()(const glm::vec3& v) { return {(*this)(v.x), (*this)(v.y), (*this)(v.z)}; }

  private:
    CounterRandom random_;
};

bool trace_closest(const JitteredContext& context, const shading::Ray& ray, const shading::Sampler& numbers,
                   const shading::Skip& skip, shading::Hit& hit) {
    Jitter jitter(shading::hash_combine(numbers.seed, numbers.index), ray.origin);
    const embree::Context& exact = context;
    if (!embree::trace_closest(exact, {ray.origin, jitter(ray.direction)}, numbers, skip, hit)) return false;
    hit.barycentric = {jitter(hit.barycentric.x), jitter(hit.barycentric.y)};
    hit.distance = jitter(hit.distance);
    return true;
}

bool trace_occluded(const JitteredContext& context, const glm::vec3& origin, const glm::vec3& segment,
                    float far, const shading::Sampler& numbers, shading::ThinWalls& walls) {
    const embree::Context& exact = context;
    Jitter jitter(shading::hash_combine(numbers.seed, numbers.index), origin);
    return embree::trace_occluded(exact, origin, jitter(segment), far, numbers, walls);
}

}  // namespace

JitteredEmbree::JitteredEmbree(const tools::bench::BenchScene& scene)
    : device_(embree::make_device({.blobs = blobs_})), adapter_(device_.get(), blobs_) {
    for (const scene::BlobPtr& blob : scene.blobs) blobs_->insert(blob);
    if (auto applied = adapter_.apply(scene::snapshot(scene.content)); !applied) throw applied.error();
    if (auto committed = adapter_.commit(); !committed) throw committed.error();
}

frame::FilmTile JitteredEmbree::film(const view::View& view, const Rect& tile, std::uint64_t sample) const {
    frame::FilmTile film(tile, {sample, 0}, view.channels);
    shading::Scene scene = backend::on_host(adapter_.tables());
    const auto places = backend::camera_keys(view.camera, adapter_.tables().render_origin);
    shading::View record = backend::make_view(view, adapter_.tables().render_origin);
    record.camera_keys.items = places.data();
    scene.features = backend::features_for(adapter_.tables(), record);
    std::size_t pixel = 0;
    for (std::int32_t y = tile.y; y < tile.bottom(); ++y) {
        for (std::int32_t x = tile.x; x < tile.right(); ++x, ++pixel) {
            const auto px = static_cast<std::uint32_t>(x), py = static_cast<std::uint32_t>(y);
            const float time = shading::sample_time(scene.features, record, px, py, sample);
            const JitteredContext context{{{}, {scene, record, adapter_.scene(), time}}};
            const shading::Path path = shading::trace_sample(context, px, py, sample);
            const shading::SampleValues values = shading::sample_values(record, path.found);
            frame::put_sample(film, pixel, {values.items, values.count});
        }
    }
    return film;
}

}  // namespace tessera::test
