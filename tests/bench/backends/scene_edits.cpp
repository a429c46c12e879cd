#include "tests/bench/backends/scene_edits.h"

#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>

#include "mediator/backend/flattening.h"
#include "mediator/scene/fields.h"

namespace tessera::tools::bench {

namespace {

using scene::Geometry, scene::Root, scene::Transform;

// About a thousandth of the mesh's size or position.
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

// The transform directly above the instance; if there is none, a new one between the root and the mesh.
ObjectId transform_of(scene::Scene& scene, const backend::Instance& instance) {
    if (!instance.path.empty()) return instance.path.back();
    const ObjectId object_transform{scene.objects().rbegin()->first.value + 1};
    Root root = *scene.find_as<Root>(scene::RootId);
    std::replace(root.children.begin(), root.children.end(), instance.geometry, object_transform);
    carry_out(scene, {scene::Create{object_transform, Transform{.children = {instance.geometry}}},
                      update<Root>(scene::RootId, &Root::children, root)});
    return object_transform;
}

}  // namespace

EditedScene with_edits(BenchScene scene) {
    EditedScene edited{.scene = std::move(scene), .blobs = std::make_shared<scene::BlobStore>()};
    scene::Scene& content = edited.scene.content;
    for (const scene::BlobPtr& blob : edited.scene.blobs) edited.blobs->insert(blob);
    const auto flat_scene = backend::flatten(content);
    if (!flat_scene) throw flat_scene.error();
    const auto largest = std::ranges::max_element(
        flat_scene->instances, {},
        [&](const backend::Instance& instance) { return triangles_of(content, instance.geometry); });
    if (largest == flat_scene->instances.end()) {
        throw Error(ErrorCode::InvalidInput, "scene '" + edited.scene.name + "' has no mesh to measure with");
    }
    for (const backend::Instance& instance : flat_scene->instances) {
        edited.triangles += triangles_of(content, instance.geometry);
    }
    edited.instances = flat_scene->instances.size();

    const ObjectId mesh = largest->geometry, object_transform = transform_of(content, *largest);
    Geometry geometry = *content.find_as<Geometry>(mesh);
    geometry.hint = scene::MotionHint::Animated;
    carry_out(content, {update<Geometry>(mesh, &Geometry::hint, geometry)});
    edited.snapshot = scene::snapshot(content);

    scene::Scene after = content;
    const auto positions = edited.blobs->find(geometry.positions.hash)->as<float>();
    std::vector<float> stretched(positions.begin(), positions.end());
    for (float& value : stretched) value *= Stretch;
    geometry.positions = scene::reference(*edited.blobs->insert(std::as_bytes(std::span(stretched))));
    edited.deformation = step(after, {update<Geometry>(mesh, &Geometry::positions, geometry)});
    Transform transform = *after.find_as<Transform>(object_transform);
    transform.matrix = glm::translate(glm::dmat4(1.0), glm::dvec3(Shift)) * transform.matrix;
    edited.movement = step(after, {update<Transform>(object_transform, &Transform::matrix, transform)});
    return edited;
}

}  // namespace tessera::tools::bench
