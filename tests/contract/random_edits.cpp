#include "tests/contract/random_edits.h"

#include <algorithm>

#include "mediator/backend/flattening.h"

namespace tessera::test {

using scene::Geometry;
using scene::ObjectKind;
using scene::Transform;

namespace {

constexpr std::size_t ManyInstances = 200;

}  // namespace

scene::ChangeList RandomEdits::next() {
    scene::SceneEditor editor(builder_.scene());
    while (editor.empty()) {
        const std::uint64_t changes = 1 + random_.below(4);
        for (std::uint64_t i = 0; i < changes; ++i) change(editor);
    }
    return builder_.edit(editor.take());
}

void RandomEdits::change(scene::SceneEditor& editor) {
    const bool crowded = backend::flatten(builder_.scene())->instances.size() > ManyInstances;
    switch (random_.below(12)) {
        case 0:
        case 1:
            return crowded ? remove_child(editor) : grow(editor);
        case 2:
            return remove_child(editor);
        case 3:
            return crowded ? remove_child(editor) : add_shared_child(editor);
        case 4:
        case 5:
            return deform(editor);
        case 6:
        case 7:
            return tint(editor);
        default:
            if (const ObjectId id = any(ObjectKind::Transform); editor.find(id)) {
                Transform changed = transform(placement(), {});
                changed.layers = layers();
                const bool moves = random_.below(4) != 0;
                using Changed = scene::Fields<Transform>;
                editor.update<Transform>(
                    id, moves ? Changed(&Transform::matrix) : Changed(&Transform::layers), changed);
            }
    }
}

void RandomEdits::grow(scene::SceneEditor& editor) {
    const ObjectId transform_id{next_id_++}, content_id{next_id_++};
    if (random_.below(4) == 0) {
        scene::Light light;
        light.intensity = {5 * unit(), 5 * unit(), 5 * unit()};
        editor.create(content_id, light);
    } else {
        editor.create(content_id, square(blobs_, 0.1f + 0.4f * unit(), any(ObjectKind::Material)));
    }
    Transform created = transform(placement(), {content_id});
    created.hint = static_cast<scene::MotionHint>(random_.below(3));
    created.layers = layers();
    editor.create(transform_id, created);
    hook(editor, any(ObjectKind::Transform), transform_id);
}

void RandomEdits::remove_child(scene::SceneEditor& editor) {
    const ObjectId victim = any(random_.below(3) == 0 ? ObjectKind::Geometry : ObjectKind::Transform);
    if (!victim || ids(ObjectKind::Geometry).size() < 3 || !editor.find(victim)) return;
    for (const ObjectId parent : ids(ObjectKind::Transform)) {
        const scene::Object* object = editor.find(parent);
        const auto* holder = object ? std::get_if<Transform>(object) : nullptr;
        if (!holder || parent == victim) continue;
        Transform without = *holder;
        if (std::erase(without.children, victim) != 0) {
            editor.update<Transform>(parent, &Transform::children, without);
        }
    }
    scene::Root root = std::get<scene::Root>(*editor.find(scene::RootId));
    if (std::erase(root.children, victim) != 0) {
        editor.update<scene::Root>(scene::RootId, &scene::Root::children, root);
    }
    editor.remove(victim);
}

void RandomEdits::add_shared_child(scene::SceneEditor& editor) {
    const ObjectId a = any(ObjectKind::Transform);
    const ObjectId b = any(random_.below(2) == 0 ? ObjectKind::Geometry : ObjectKind::Transform);
    if (a < b) hook(editor, a, b);
}

void RandomEdits::deform(scene::SceneEditor& editor) {
    const ObjectId id = any(ObjectKind::Geometry);
    if (!id || !editor.find(id)) return;
    Geometry deformed = square(blobs_, 0.1f + 0.4f * unit(), any(ObjectKind::Material));
    deformed.hint = static_cast<scene::MotionHint>(random_.below(3));
    switch (random_.below(4)) {
        case 0:
            return editor.update<Geometry>(id, &Geometry::positions, deformed);
        case 1:
            return editor.update<Geometry>(id, &Geometry::material, deformed);
        case 2:
            return editor.update<Geometry>(id, &Geometry::hint, deformed);
        default:
            deformed.indices = array_blob<std::uint32_t>(blobs_, {0, 1, 2});
            return editor.update<Geometry>(id, {&Geometry::indices, &Geometry::name}, deformed);
    }
}

void RandomEdits::tint(scene::SceneEditor& editor) {
    switch (random_.below(4)) {
        case 0: {
            scene::Material material;
            material.base_color = {unit(), unit(), unit(), 1.0f};
            if (random_.below(3) == 0) material.emission = {unit(), unit(), unit()};
            if (random_.below(3) == 0) material.transmission = unit();
            if (random_.below(3) == 0) material.roughness = 0.0f;
            return editor.update<scene::Material>(
                any(ObjectKind::Material),
                {&scene::Material::base_color, &scene::Material::emission, &scene::Material::transmission,
                 &scene::Material::roughness},
                material);
        }
        case 1:
            if (const ObjectId id = any(ObjectKind::Light)) {
                scene::Light light;
                light.intensity = {5 * unit(), 5 * unit(), 5 * unit()};
                editor.update<scene::Light>(id, &scene::Light::intensity, light);
            }
            return;
        case 2: {
            scene::Background sky;
            sky.color = {unit(), unit(), unit()};
            return editor.update<scene::Background>(Sky, &scene::Background::color, sky);
        }
        default: {
            scene::Root root;
            root.render_origin = {static_cast<double>(random_.below(3)), 0.0, 0.0};
            return editor.update<scene::Root>(scene::RootId, &scene::Root::render_origin, root);
        }
    }
}

std::vector<ObjectId> RandomEdits::ids(ObjectKind kind) const {
    std::vector<ObjectId> found;
    for (const auto& [id, object] : builder_.scene().objects()) {
        if (scene::kind(*object) == kind) found.push_back(id);
    }
    return found;
}

ObjectId RandomEdits::any(ObjectKind kind) {
    const std::vector<ObjectId> all = ids(kind);
    return all.empty() ? ObjectId{} : all[random_.below(all.size())];
}

glm::dmat4 RandomEdits::placement() {
    const auto spread = [&] { return 2.0 * random_.uniform() - 1.0; };
    return glm::rotate(moved(spread(), spread(), -2.0 + spread()), spread(), glm::dvec3(0.2, 1.0, 0.1));
}

void RandomEdits::hook(scene::SceneEditor& editor, ObjectId parent, ObjectId child) {
    const scene::Object* object = parent ? editor.find(parent) : nullptr;
    if (object && std::holds_alternative<Transform>(*object)) {
        Transform more = std::get<Transform>(*object);
        more.children.push_back(child);
        editor.update<Transform>(parent, &Transform::children, more);
    } else {
        scene::Root root = std::get<scene::Root>(*editor.find(scene::RootId));
        root.children.push_back(child);
        editor.update<scene::Root>(scene::RootId, &scene::Root::children, root);
    }
}

}  // namespace tessera::test
