#include "client/import/tessera_import.h"

#include <algorithm>
#include <set>

#include "client/import/environment.h"
#include "client/import/limits.h"
#include "client/import/post_process.h"
#include "client/import/scene_stats.h"
#include "client/import/tessera_format.h"
#include "mediator/scene/references.h"
#include "mediator/scene/scene.h"

namespace tessera::import {
namespace {

// Gathers statistics and cameras of a complete scene.
class SceneTraversal {
  public:
    SceneTraversal(const scene::Scene& scene, ImportedScene& result) : scene_(scene), result_(result) {
        for (const scene::BlobPtr& blob : result.blobs) blobs_.insert(blob);
    }

    Bounds run(const std::vector<ObjectId>& roots) {
        for (const ObjectId child : roots) stack_.push_back({child, glm::dmat4(1.0)});
        while (!stack_.empty()) {
            const Visit current = stack_.back();
            stack_.pop_back();
            visit(current);
        }
        std::stable_sort(cameras_.begin(), cameras_.end(),
                         [](const auto& a, const auto& b) { return a.first < b.first; });
        for (auto& [unused, camera] : cameras_) result_.cameras.push_back(std::move(camera));
        return bounds_;
    }

  private:
    struct Visit {
        ObjectId object;
        glm::dmat4 parent{1.0};
    };

    void visit(const Visit& current) {
        if (++visits_ > MaxInstances) {
            throw Error(ErrorCode::InvalidInput, "it has more than " + std::to_string(MaxInstances) +
                                                     " object instances: split the scene");
        }
        const scene::Object& object = *scene_.find(current.object);
        if (const auto* transform = std::get_if<scene::Transform>(&object)) {
            for (const ObjectId child : transform->children)
                stack_.push_back({child, current.parent * transform->matrix});
        } else if (const auto* geometry = std::get_if<scene::Geometry>(&object)) {
            ++result_.counts.instances;
            bounds_.add(box(current.object, *geometry), current.parent);
        } else if (std::holds_alternative<scene::Light>(object)) {
            ++result_.counts.lights;
        } else if (const auto* camera = std::get_if<scene::Camera>(&object)) {
            add_camera(current, *camera);
        }
    }

    const Bounds& box(ObjectId id, const scene::Geometry& geometry) {
        const auto [entry, is_new] = boxes_.try_emplace(id);
        if (is_new) {
            const scene::BlobPtr positions = blobs_.find(geometry.positions.hash);
            for (const glm::vec3& point : positions->as<glm::vec3>()) entry->second.add(glm::dvec3(point));
        }
        return entry->second;
    }

    void add_camera(const Visit& current, const scene::Camera& camera) {
        glm::dmat4 world = current.parent;
        if (!make_rigid(world)) {
            result_.notices.push_back("camera '" + camera.name +
                                      "' is not used: its transform is degenerate");
            return;
        }
        const std::string base = camera.name.empty() ? "camera" : camera.name;
        std::string name = base;
        for (int suffix = 2; !names_.insert(name).second; ++suffix)
            name = base + "." + std::to_string(suffix);
        cameras_.emplace_back(current.object, CameraInfo{name, world, camera});
    }

    const scene::Scene& scene_;
    ImportedScene& result_;
    scene::BlobStore blobs_;
    std::vector<Visit> stack_;
    std::uint64_t visits_ = 0;
    Bounds bounds_;
    std::map<ObjectId, Bounds> boxes_;
    std::set<std::string> names_;
    std::vector<std::pair<ObjectId, CameraInfo>> cameras_;
};

void count(const scene::Scene& scene, ImportCounts& counts) {
    for (const auto& [id, object] : scene.objects()) {
        if (std::holds_alternative<scene::Texture>(*object)) ++counts.textures;
        const auto* geometry = std::get_if<scene::Geometry>(object.get());
        if (geometry == nullptr) continue;
        ++counts.geometries;
        counts.triangles += geometry->indices.byte_size / 12;
        const auto is_emissive = [&](ObjectId shading_object) {
            const scene::Object* found = scene.find(shading_object);
            return found != nullptr && emits(*found);
        };
        if (is_emissive(geometry->material) || is_emissive(geometry->medium)) ++counts.emissive_geometries;
    }
}

// Renumbers the ids of the file consecutively, in the same order.
void renumber_objects(const scene::Scene& scene, SceneBuilder& builder) {
    ImportedScene& result = builder.result();
    const ImportOptions& options = builder.options();
    if (scene.objects().size() - 1 > options.end_id.value - options.first_id.value) {
        throw Error(ErrorCode::InvalidInput,
                    "it needs more than the " +
                        std::to_string(options.end_id.value - options.first_id.value) +
                        " objects that are allowed: split the scene");
    }
    std::map<ObjectId, ObjectId> renumbered{{ObjectId{}, ObjectId{}}};
    ObjectId next = options.first_id;
    for (const auto& [id, unused] : scene.objects()) {
        if (id != scene::RootId) renumbered[id] = {next.value++};
    }
    for (const auto& [id, object] : scene.objects()) {
        scene::Object copy = *object;
        scene::for_each_reference(copy, [&](ObjectId& reference) { reference = renumbered.at(reference); });
        if (id == scene::RootId) {
            result.root = std::get<scene::Root>(std::move(copy));
        } else {
            result.objects.push_back({renumbered.at(id), std::move(copy)});
        }
    }
}

void apply_options(SceneBuilder& builder) {
    const ImportOptions& options = builder.options();
    if (!options.background && options.environment.empty()) return;
    scene::Root& root = builder.result().root;
    if (!root.background) {
        scene::Background background;
        background.name = "background";
        root.background = builder.add(std::move(background));
    }
    if (options.background) builder.get<scene::Background>(root.background).color = *options.background;
    if (options.environment.empty()) return;
    const ObjectId environment = add_environment(options.environment, builder);
    auto& background = builder.get<scene::Background>(root.background);
    background.environment = environment;
    background.strength = options.environment_strength;
    background.rotation = options.environment_rotation;
    background.map_center = scene::MapCenter::PositiveX;
    auto& blobs = builder.result().blobs;  // the file may already contain the same map
    const Hash256 last = blobs.back()->hash();
    if (std::any_of(blobs.begin(), blobs.end() - 1, [&](const auto& one) { return one->hash() == last; }))
        blobs.pop_back();
}

}  // namespace

void import_tessera(const std::filesystem::path& file, SceneBuilder& builder) {
    auto content = read_tessera(file);
    if (!content) throw content.error();
    scene::Scene scene;
    if (const auto applied = scene.apply(content->snapshot); !applied) throw applied.error();
    ImportedScene& result = builder.result();
    result.blobs = std::move(content->blobs);
    count(scene, result.counts);
    renumber_objects(scene, builder);

    scene::Scene renumbered;
    if (const auto applied = renumbered.apply_entries(entries(result, RootEntry::Create)); !applied)
        throw applied.error();
    const Bounds bounds = SceneTraversal(renumbered, result).run(result.root.children);
    apply_options(builder);
    if (result.cameras.empty() && builder.options().missing == Missing::Add)
        add_framing_camera(builder, bounds);
}

}  // namespace tessera::import
