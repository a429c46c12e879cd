#include "client/import/configure.h"

#include <algorithm>
#include <map>
#include <set>

namespace tessera::import {

namespace {

class Configurator {
  public:
    explicit Configurator(ImportedScene& scene) : scene_(scene) {
        for (scene::Create& entry : scene.objects) by_id_[entry.id] = &entry.object;
    }

    Expected<void> hide(const std::string& name) {
        const std::set<ObjectId> parts = named(name);
        if (parts.empty())
            return failure(ErrorCode::InvalidInput, "there is no part '" + name + "' to hide" + part_names());
        const auto remove = [&](std::vector<ObjectId>& children) {
            std::erase_if(children, [&](ObjectId child) { return parts.contains(child); });
        };
        remove(scene_.root.children);
        for (auto& [id, unseen] : scene_.without_volume) remove(unseen);
        for (auto& [id, object] : by_id_) {
            if (auto* transform = std::get_if<scene::Transform>(object)) remove(transform->children);
        }
        return {};
    }

    Expected<void> paint(const std::string& part, const std::string& material) {
        ObjectId chosen;
        for (const auto& [id, object] : by_id_) {
            const std::string* candidate = name_of_material(*object);
            if (candidate != nullptr && *candidate == material && chosen.value == 0) chosen = id;
        }
        if (chosen.value == 0) {
            return failure(ErrorCode::InvalidInput,
                           "there is no material '" + material + "'" + material_names());
        }
        std::size_t painted = 0;
        for (const ObjectId id : named(part)) painted += paint(id, chosen);
        if (painted == 0) {
            return failure(ErrorCode::InvalidInput,
                           "there is no part '" + part + "' with a surface" + part_names());
        }
        return {};
    }

  private:
    static const std::string* name_of_part(const scene::Object& object) {
        if (const auto* transform = std::get_if<scene::Transform>(&object)) return &transform->name;
        if (const auto* geometry = std::get_if<scene::Geometry>(&object)) return &geometry->name;
        if (const auto* light = std::get_if<scene::Light>(&object)) return &light->name;
        return nullptr;
    }

    static const std::string* name_of_material(const scene::Object& object) {
        if (const auto* material = std::get_if<scene::Material>(&object)) return &material->name;
        if (const auto* shader = std::get_if<scene::SurfaceShader>(&object)) return &shader->name;
        return nullptr;
    }

    std::set<ObjectId> named(const std::string& name) const {
        std::set<ObjectId> ids;
        for (const auto& [id, object] : by_id_) {
            const std::string* found = name_of_part(*object);
            if (found != nullptr && *found == name) ids.insert(id);
        }
        return ids;
    }

    // Importers create graphs without cycles.
    std::size_t paint(ObjectId id, ObjectId material) {
        const auto found = by_id_.find(id);
        if (found == by_id_.end()) return 0;
        if (auto* geometry = std::get_if<scene::Geometry>(found->second)) {
            geometry->material = material;
            return 1;
        }
        std::size_t painted = 0;
        if (const auto* transform = std::get_if<scene::Transform>(found->second)) {
            for (const ObjectId child : transform->children) painted += paint(child, material);
        }
        return painted;
    }

    static std::string list(const std::set<std::string>& names, const char* what) {
        constexpr std::size_t Most = 24;
        std::string text;
        std::size_t count = 0;
        for (const std::string& name : names) {
            if (name.empty() || count++ == Most) continue;
            text += (text.empty() ? "" : ", ") + name;
        }
        return text.empty() ? std::string(": the file names none") : std::string(": ") + what + " " + text;
    }
    std::string part_names() const {
        std::set<std::string> names;
        for (const auto& [id, object] : by_id_) {
            if (const std::string* name = name_of_part(*object)) names.insert(*name);
        }
        return list(names, "the parts are");
    }
    std::string material_names() const {
        std::set<std::string> names;
        for (const auto& [id, object] : by_id_) {
            if (const std::string* name = name_of_material(*object)) names.insert(*name);
        }
        return list(names, "the materials are");
    }

    ImportedScene& scene_;
    std::map<ObjectId, scene::Object*> by_id_;
};

}  // namespace

Expected<void> configure(ImportedScene& scene, const Configuration& configuration) {
    Configurator configurator(scene);
    for (const auto& [part, material] : configuration.materials) {
        if (auto done = configurator.paint(part, material); !done) return done;
    }
    for (const std::string& name : configuration.hidden) {
        if (auto done = configurator.hide(name); !done) return done;
    }
    return {};
}

}  // namespace tessera::import
