#include "mediator/backend/shadow_scene.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "mediator/scene/motion.h"

namespace tessera::backend {

using scene::Fields;
using scene::Geometry;
using scene::Object;
using scene::Root;
using scene::Transform;

namespace {

template <class Set>
std::vector<typename Set::value_type> listed(const Set& set) {
    return {set.begin(), set.end()};
}

template <class T>
bool names_only(scene::FieldMask mask) {
    return Fields<T>::from_bits(mask) == Fields<T>(&T::name);
}

bool is_name_only(const Object& object, scene::FieldMask mask) {
    return std::visit([&]<class T>(const T&) { return names_only<T>(mask); }, object);
}

}  // namespace

SceneDelta everything_in(const scene::Scene& scene) {
    SceneDelta all{.everything = true, .instances_changed = true, .lights_changed = true};
    for (const auto& [id, object] : scene.objects()) {
        if (std::holds_alternative<Geometry>(*object)) all.geometries.push_back({id, {}});
    }
    return all;
}

Expected<void> ShadowScene::apply(const scene::ChangeList& changes) {
    const Expected<scene::Scene> after = scene::after(scene_, changes);
    return after ? apply(changes, *after) : tl::unexpected(after.error());
}

Expected<void> ShadowScene::apply(const scene::ChangeList& changes, const scene::Scene& after) {
    if (changes.to != after.version() || !(changes.is_snapshot() || changes.from == scene_.version())) {
        return failure(
            ErrorCode::InvalidInput,
            "the change list does not start at the version of the back-end's scene: send a snapshot");
    }
    const Touched touched = touch(changes);
    Undo undo;
    if (touched.structure || changes.is_snapshot()) {
        Expected<FlatScene> flat_scene = flatten(after);
        if (!flat_scene) return tl::unexpected(flat_scene.error());
        undo.flat_scene = std::exchange(flat_scene_, std::move(*flat_scene));
        forget_index();
    }
    undo.scene = std::exchange(scene_, after);
    if (!undo.flat_scene) {
        undo.moved_transforms = touched.moved_transforms;
        if (move_below(touched.moved_transforms, moved_)) delta_.lights_changed = true;
    }
    if (changes.is_snapshot()) replace_everything();
    record(touched);
    if (undo.flat_scene && !changes.is_snapshot()) record_reflattening(*undo.flat_scene);
    undo_.push_back(std::move(undo));
    return {};
}

void ShadowScene::replace_everything() {
    delta_ = {};
    delta_.everything = delta_.instances_changed = delta_.lights_changed = true;
    delta_.background_changed = delta_.render_origin_changed = true;
    for (auto* ids : {&created_geometries_, &removed_geometries_, &materials_, &textures_}) ids->clear();
    changed_geometries_.clear();
    moved_.clear();
}

void ShadowScene::record(const Touched& touched) {
    for (const ObjectId id : touched.created_geometries) {
        if (removed_geometries_.erase(id) == 0) created_geometries_.insert(id);
        changed_geometries_[id] = Fields<Geometry>::all().bits();
    }
    for (const SceneDelta::GeometryChange& change : touched.changed_geometries) {
        changed_geometries_[change.id] |= change.fields.bits();
    }
    for (const ObjectId id : touched.removed_geometries) {
        changed_geometries_.erase(id);
        if (created_geometries_.erase(id) == 0) removed_geometries_.insert(id);
    }
    materials_.insert(touched.materials.begin(), touched.materials.end());
    textures_.insert(touched.textures.begin(), touched.textures.end());
    ignored_kinds_.insert(touched.ignored_kinds.begin(), touched.ignored_kinds.end());
    delta_.background_changed |= touched.background;
    delta_.render_origin_changed |= touched.render_origin;
    delta_.entries += touched.entries;
    delta_.relevant += touched.relevant;
    for (const ObjectId id : touched.light_values) {
        delta_.lights_changed |= std::any_of(flat_scene_.lights.begin(), flat_scene_.lights.end(),
                                             [&](const PlacedLight& placed) { return placed.light == id; });
    }
}

void ShadowScene::record_reflattening(const FlatScene& before) {
    const auto same_member = [](const Instance& a, const Instance& b) {
        return a.geometry == b.geometry && a.path == b.path && a.hint == b.hint;
    };
    const auto same_light = [](const PlacedLight& a, const PlacedLight& b) {
        return a.light == b.light && a.path == b.path && a.world_from_light == b.world_from_light &&
               a.layers == b.layers && a.motion == b.motion;
    };
    const auto& now = flat_scene_.instances;
    if (std::equal(now.begin(), now.end(), before.instances.begin(), before.instances.end(), same_member)) {
        for (std::uint32_t i = 0; i < now.size(); ++i) {
            const Instance& old = before.instances[i];
            const bool is_same = now[i].world_from_object == old.world_from_object &&
                                 now[i].layers == old.layers && now[i].motion == old.motion;
            if (!is_same) moved_.insert(i);
        }
    } else {
        delta_.instances_changed = true;
    }
    if (!std::equal(flat_scene_.lights.begin(), flat_scene_.lights.end(), before.lights.begin(),
                    before.lights.end(), same_light)) {
        delta_.lights_changed = true;
    }
}

bool ShadowScene::move_below(const std::vector<ObjectId>& transforms, std::set<std::uint32_t>& moved) {
    if (transforms.empty()) return false;
    index_paths();
    bool lights = false;
    for (const ObjectId transform : transforms) {
        if (const auto below = instances_below_.find(transform); below != instances_below_.end()) {
            for (const std::uint32_t i : below->second) {
                Instance& instance = flat_scene_.instances[i];
                instance.world_from_object = placement(scene_, instance.path);
                instance.motion = scene::motion_along(scene_, instance.path);
                moved.insert(i);
            }
        }
        if (const auto below = lights_below_.find(transform); below != lights_below_.end()) {
            for (const std::uint32_t i : below->second) {
                PlacedLight& light = flat_scene_.lights[i];
                light.world_from_light = placement(scene_, light.path);
                light.motion = scene::motion_along(scene_, light.path);
                lights = true;
            }
        }
    }
    return lights;
}

void ShadowScene::index_paths() {
    if (indexed_) return;
    for (std::uint32_t i = 0; i < flat_scene_.instances.size(); ++i) {
        for (const ObjectId id : flat_scene_.instances[i].path) instances_below_[id].push_back(i);
    }
    for (std::uint32_t i = 0; i < flat_scene_.lights.size(); ++i) {
        for (const ObjectId id : flat_scene_.lights[i].path) lights_below_[id].push_back(i);
    }
    indexed_ = true;
}

void ShadowScene::forget_index() {
    indexed_ = false;
    instances_below_.clear();
    lights_below_.clear();
}

SceneDelta ShadowScene::pending() const {
    SceneDelta delta = delta_;
    if (!delta.instances_changed) delta.moved_instances = listed(moved_);
    for (const auto& [id, fields] : changed_geometries_) {
        delta.geometries.push_back({id, Fields<Geometry>::from_bits(fields)});
    }
    std::sort(delta.geometries.begin(), delta.geometries.end(),
              [](const auto& a, const auto& b) { return a.id < b.id; });
    delta.removed_geometries = listed(removed_geometries_);
    delta.materials = listed(materials_);
    delta.textures = listed(textures_);
    delta.ignored_kinds = listed(ignored_kinds_);
    return delta;
}

void ShadowScene::accept() {
    for (auto* ids : {&created_geometries_, &removed_geometries_, &materials_, &textures_}) ids->clear();
    ignored_kinds_.clear();
    changed_geometries_.clear();
    moved_.clear();
    undo_.clear();
    delta_ = {};
}

SceneDelta ShadowScene::take_delta() {
    SceneDelta delta = pending();
    accept();
    return delta;
}

void ShadowScene::rollback() {
    while (!undo_.empty()) {
        Undo undo = std::move(undo_.back());
        undo_.pop_back();
        scene_ = std::move(undo.scene);
        if (undo.flat_scene) {
            flat_scene_ = std::move(*undo.flat_scene);
            forget_index();
        } else {
            std::set<std::uint32_t> moved;
            move_below(undo.moved_transforms, moved);
        }
    }
    accept();
}

ShadowScene::Touched ShadowScene::touch(const scene::ChangeList& changes) const {
    Touched touched;
    touched.entries = static_cast<std::uint32_t>(changes.entries.size());
    for (const scene::Entry& entry : changes.entries) {
        if (const auto* create = std::get_if<scene::Create>(&entry)) {
            touch_created(touched, create->id, create->object);
        } else if (const auto* update = std::get_if<scene::Update>(&entry)) {
            touch_updated(touched, *update);
        } else if (const Object* object = scene_.find(scene::id(entry))) {
            touch_removed(touched, scene::id(entry), *object);
        }
    }
    return touched;
}

void ShadowScene::touch_created(Touched& touched, ObjectId id, const Object& object) {
    ++touched.relevant;
    switch (scene::kind(object)) {
        case scene::ObjectKind::Root:
            touched.structure = touched.background = touched.render_origin = true;
            break;
        case scene::ObjectKind::Geometry:
            touched.created_geometries.push_back(id);
            touched.structure = true;
            break;
        case scene::ObjectKind::Transform:
        case scene::ObjectKind::Light:
            touched.structure = true;
            break;
        case scene::ObjectKind::Material:
        case scene::ObjectKind::SurfaceShader:
        case scene::ObjectKind::Medium:
            touched.materials.push_back(id);
            break;
        case scene::ObjectKind::Texture:
            touched.textures.push_back(id);
            break;
        case scene::ObjectKind::Background:
            touched.background = true;
            break;
        case scene::ObjectKind::Camera:
            --touched.relevant;
            break;
        case scene::ObjectKind::Attachment:
            --touched.relevant;
            touched.ignored_kinds.insert(scene::name(scene::ObjectKind::Attachment));
            break;
    }
}

void ShadowScene::touch_removed(Touched& touched, ObjectId id, const Object& object) {
    touch_created(touched, id, object);
    if (std::holds_alternative<Geometry>(object)) {
        touched.created_geometries.pop_back();
        touched.removed_geometries.push_back(id);
    }
}

void ShadowScene::touch_updated(Touched& touched, const scene::Update& update) const {
    const scene::FieldMask mask = update.mask;
    if (scene::kind(update.fields) == scene::ObjectKind::Attachment) {
        touched.ignored_kinds.insert(scene::name(scene::ObjectKind::Attachment));
        return;
    }
    if (is_name_only(update.fields, mask) || std::holds_alternative<scene::Camera>(update.fields)) return;
    ++touched.relevant;
    if (std::holds_alternative<Root>(update.fields)) {
        const auto fields = Fields<Root>::from_bits(mask);
        touched.structure |= fields.contains(&Root::children);
        touched.background |= fields.contains(&Root::background);
        touched.render_origin |= fields.contains(&Root::render_origin);
    } else if (std::holds_alternative<Transform>(update.fields)) {
        const auto fields = Fields<Transform>::from_bits(mask);
        touched.structure |= fields.intersects({&Transform::children, &Transform::hint, &Transform::layers});
        if (fields.intersects({&Transform::matrix, &Transform::motion}))
            touched.moved_transforms.push_back(update.id);
    } else if (std::holds_alternative<Geometry>(update.fields)) {
        const auto fields = Fields<Geometry>::from_bits(mask);
        touched.structure |= fields.contains(&Geometry::hint);
        touched.changed_geometries.push_back({update.id, fields});
    } else if (std::holds_alternative<scene::Light>(update.fields)) {
        touched.light_values.push_back(update.id);
    } else {
        touch_created(touched, update.id, update.fields);
        --touched.relevant;
    }
}

}  // namespace tessera::backend
