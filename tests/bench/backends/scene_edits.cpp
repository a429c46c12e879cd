#include "tests/bench/backends/scene_edits.h"

#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>

#include "mediator/backend/lowering.h"
#include "mediator/scene/fields.h"

namespace tessera::tools::bench {

namespace {

using scene::Geometry, scene::Root, scene::Transform;

// About a thousandth of the mesh's size, or of its place.
constexpr float Stretch = 1.001f;
constexpr double Shift = 0.001;

template <class T>
scene::Update update(ObjectId id, scene::Fields<T> fields, const T& value) {
    return {id, fields.bits(), value};
}

void carry_out(scene::Scene& scene, const std::vector<scene::Entry>& entries) {
    if (auto applied = scene.apply_entries(entries); !applied) throw applied.error();
}

scene::ChangeList step(scene::Scene& scene, std::vector<scene::Entry> entries) {
    const Version from = scene.version();
    scene::ChangeList list{from, {from.epoch, from.number + 1}, std::move(entries), {}};
    carry_out(scene, list.entries);
    scene.set_version(list.to);
    list.state_hash = scene.state_hash();
    return list;
}

std::uint64_t triangles_of(const scene::Scene& scene, ObjectId mesh) {
    const auto* geometry = scene.find_as<Geometry>(mesh);
    if (geometry->indices.empty()) return geometry->positions.byte_size / (9 * sizeof(float));
    return geometry->indices.byte_size / (3 * sizeof(std::uint32_t));
}

// The transform right above the instance; where there is none, a new one between the root and the mesh.
ObjectId place_of(scene::Scene& scene, const backend::Instance& instance) {
    if (!instance.path.empty()) return instance.path.back();
    const ObjectId place{scene.objects().rbegin()->first.value + 1};
    Root root = *scene.find_as<Root>(scene::RootId);
    std::replace(root.children.begin(), root.children.end(), instance.geometry, place);
    carry_out(scene, {scene::Create{place, Transform{.children = {instance.geometry}}},
                      update<Root>(scene::RootId, &Root::children, root)});
    return place;
}

}  // namespace

EditedScene with_edits(BenchScene made) {
    EditedScene edited{.scene = std::move(made), .blobs = std::make_shared<scene::BlobStore>()};
    scene::Scene& content = edited.scene.content;
    for (const scene::BlobPtr& blob : edited.scene.blobs) edited.blobs->insert(blob);
    const auto lowered = backend::lower(content);
    if (!lowered) throw lowered.error();
    const auto largest = std::ranges::max_element(
        lowered->instances, {},
        [&](const backend::Instance& instance) { return triangles_of(content, instance.geometry); });
    if (largest == lowered->instances.end()) {
        throw Error(ErrorCode::InvalidInput, "scene '" + edited.scene.name + "' has no mesh to measure with");
    }
    for (const backend::Instance& instance : lowered->instances) {
        edited.triangles += triangles_of(content, instance.geometry);
    }
    edited.instances = lowered->instances.size();

    const ObjectId mesh = largest->geometry, place = place_of(content, *largest);
    Geometry geometry = *content.find_as<Geometry>(mesh);
    geometry.hint = scene::MotionHint::Animated;
    carry_out(content, {update<Geometry>(mesh, &Geometry::hint, geometry)});
    edited.everything = scene::snapshot(content);

    scene::Scene after = content;
    const auto positions = edited.blobs->find(geometry.positions.hash)->as<float>();
    std::vector<float> stretched(positions.begin(), positions.end());
    for (float& value : stretched) value *= Stretch;
    geometry.positions = scene::reference(*edited.blobs->insert(std::as_bytes(std::span(stretched))));
    edited.vertices = step(after, {update<Geometry>(mesh, &Geometry::positions, geometry)});
    Transform transform = *after.find_as<Transform>(place);
    transform.matrix = glm::translate(glm::dmat4(1.0), glm::dvec3(Shift)) * transform.matrix;
    edited.place = step(after, {update<Transform>(place, &Transform::matrix, transform)});
    return edited;
}

}  // namespace tessera::tools::bench
