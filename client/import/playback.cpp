#include "client/import/playback.h"

#include <algorithm>
#include <set>

#include "client/import/import.h"
#include "client/import/motion_keys.h"
#include "client/import/scene_stats.h"
#include "mediator/scene/fields.h"
#include "mediator/scene/inverse.h"
#include "mediator/scene/references.h"

namespace tessera::import {
namespace {

using scene::Geometry;
using scene::Transform;

constexpr scene::FieldMask MatrixBit = scene::Fields<Transform>(&Transform::matrix).bits();
constexpr scene::FieldMask MotionBit = scene::Fields<Transform>(&Transform::motion).bits();
constexpr scene::FieldMask ChildrenBit = scene::Fields<Transform>(&Transform::children).bits();

class PoseUpdate {
  public:
    PoseUpdate(ImportedScene& scene, double seconds)
        : scene_(scene),
          playback_(*scene.playback),
          seconds_(seconds),
          before_(playback_.motion.pose(scene.seconds)),
          now_(playback_.motion.pose(seconds)) {
        for (std::size_t i = 0; scene.shutter > 0.0 && i <= MotionSamples; ++i) {
            samples_.push_back(
                playback_.motion.pose(seconds + scene.shutter * double(i) / double(MotionSamples)));
        }
    }

    // Everything that may fail, before anything is changed.
    void deform() {
        for (const DeformedGeometry& geometry : playback_.deformed) {
            const auto node = static_cast<std::size_t>(geometry.node);
            const std::vector<glm::dmat4> joints = joints_of(geometry, now_);
            if (!samples_.empty()) sample_deformation(geometry);
            if (now_.weights[node] == before_.weights[node] && joints == joints_of(geometry, before_))
                continue;
            deformed_.emplace_back(&geometry, deformed(geometry, now_));
        }
    }

    SceneUpdate apply() {
        move_transforms();
        for (const auto& [geometry, mesh] : deformed_) set_arrays(geometry->geometry, mesh);
        for (const auto& [id, keys] : vertex_keys_) set_vertex_keys(id, keys);
        if (!deformed_.empty() || !vertex_keys_.empty()) update_blobs();
        update_visibility_and_cameras();
        if (!samples_.empty()) move_cameras(scene_);
        scene_.seconds = seconds_;
        for (const auto& [id, mask] : changed_)
            update_.entries.push_back(scene::Update{id, mask, scene::copy_of_fields(object(id), mask)});
        return std::move(update_);
    }

  private:
    struct Visit {
        ObjectId transform;
        glm::dmat4 parent{1.0};
        bool is_moved = false;  // by an ancestor
    };

    // Motion keys of a geometry's vertices while the shutter is open.
    struct VertexKeys {
        std::vector<std::vector<glm::vec3>> positions, normals;
    };

    MeshData deformed(const DeformedGeometry& geometry, const Pose& pose) const {
        try {
            return import::deform(*geometry.mesh, pose.weights[static_cast<std::size_t>(geometry.node)],
                                  joints_of(geometry, pose));
        } catch (const Error& error) {
            throw Error(error.code(), "mesh '" + geometry.name + "' at " + std::to_string(seconds_) +
                                          " s: " + error.what() + "; repair its animation");
        }
    }

    void sample_deformation(const DeformedGeometry& geometry) {
        std::vector<std::vector<glm::vec3>> positions, normals;
        for (const Pose& sample : samples_) {
            MeshData mesh = deformed(geometry, sample);
            positions.push_back(std::move(mesh.positions));
            normals.push_back(std::move(mesh.normals));
        }
        VertexKeys keys{motion_keys_of(positions), {}};
        // Normals at the same times, if the mesh has any.
        for (std::size_t i = 1; i <= keys.positions.size() && !normals.front().empty(); ++i) {
            keys.normals.push_back(std::move(normals[i * (MotionSamples / keys.positions.size())]));
        }
        vertex_keys_.emplace_back(geometry.geometry, std::move(keys));
    }

    scene::Object& object(ObjectId id) {
        return scene_.objects[id.value - scene_.objects.front().id.value].object;
    }

    std::vector<glm::dmat4> joints_of(const DeformedGeometry& geometry, const Pose& pose) const {
        if (geometry.skin < 0) return {};
        return joint_matrices(playback_.skins[static_cast<std::size_t>(geometry.skin)],
                              playback_.motion.nodes, pose);
    }

    void move_transforms() {
        const auto& nodes = playback_.motion.nodes;
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            const ObjectId id = playback_.transforms[i];
            if (!nodes[i].moves() || !id) continue;
            moving_.insert(id);
            for (int above = static_cast<int>(i); above >= 0;
                 above = nodes[static_cast<std::size_t>(above)].parent)
                ancestors_.insert(playback_.transforms[static_cast<std::size_t>(above)]);
            auto& transform = std::get<Transform>(object(id));
            std::vector<glm::dmat4> samples;
            for (const Pose& sample : samples_) samples.push_back(sample.local[i]);
            if (std::vector<glm::dmat4> keys = motion_keys_of(samples); transform.motion != keys) {
                transform.motion = std::move(keys);
                changed_[id] |= MotionBit;
            }
            if (transform.matrix == now_.local[i]) continue;
            transform.matrix = now_.local[i];
            changed_[id] |= MatrixBit;
        }
    }

    void set_arrays(ObjectId id, const MeshData& mesh) {
        auto& geometry = std::get<Geometry>(object(id));
        set_array(id, geometry.positions, mesh.positions, &Geometry::positions);
        set_array(id, geometry.normals, mesh.normals, &Geometry::normals);
        set_array(id, geometry.tangents, mesh.tangents, &Geometry::tangents);
    }

    template <class T>
    void set_array(ObjectId id, scene::BlobRef& reference, const std::vector<T>& values,
                   scene::Fields<Geometry> field) {
        if (values.empty()) return;
        auto blob = std::make_shared<const scene::Blob>(std::as_bytes(std::span(values)));
        if (blob->hash() == reference.hash) return;
        reference = scene::reference(*blob);
        changed_[id] |= field.bits();
        new_blobs_.emplace(blob->hash(), std::move(blob));
    }

    void set_vertex_keys(ObjectId id, const VertexKeys& keys) {
        auto& geometry = std::get<Geometry>(object(id));
        set_list(id, geometry.motion_positions, keys.positions, &Geometry::motion_positions);
        set_list(id, geometry.motion_normals, keys.normals, &Geometry::motion_normals);
    }

    void set_list(ObjectId id, std::vector<scene::BlobRef>& references,
                  const std::vector<std::vector<glm::vec3>>& keys, scene::Fields<Geometry> field) {
        std::vector<scene::BlobRef> now;
        for (const std::vector<glm::vec3>& key : keys) {
            auto blob = std::make_shared<const scene::Blob>(std::as_bytes(std::span(key)));
            now.push_back(scene::reference(*blob));
            new_blobs_.emplace(blob->hash(), std::move(blob));
        }
        if (now == references) return;
        references = std::move(now);
        changed_[id] |= field.bits();
    }

    // Removes the blobs of the previous time that nothing else refers to.
    void update_blobs() {
        std::set<Hash256> wanted;
        for (const scene::Create& create : scene_.objects) {
            for (const scene::BlobRef& blob : scene::referenced_blobs(create.object))
                wanted.insert(blob.hash);
        }
        std::erase_if(scene_.blobs, [&](const auto& blob) { return !wanted.contains(blob->hash()); });
        for (const scene::BlobPtr& blob : scene_.blobs) new_blobs_.erase(blob->hash());
        for (auto& [unused, blob] : new_blobs_) {
            update_.blobs.push_back(blob);
            scene_.blobs.push_back(std::move(blob));
        }
    }

    // For everything that moved: hides geometries under degenerate transforms, shows them again, and updates
    // camera poses.
    void update_visibility_and_cameras() {
        std::vector<Visit> stack;
        for (const ObjectId child : scene_.root.children) stack.push_back({child});
        while (!stack.empty()) {
            const Visit current = stack.back();
            stack.pop_back();
            auto* transform = std::get_if<Transform>(&object(current.transform));
            if (transform == nullptr || !(current.is_moved || ancestors_.contains(current.transform)))
                continue;
            const bool is_moved = current.is_moved || moving_.contains(current.transform);
            const glm::dmat4 world = current.parent * transform->matrix;
            if (is_moved) show_or_hide(current.transform, *transform, has_volume(world));
            for (const ObjectId child : transform->children) {
                stack.push_back({child, world, is_moved});
                if (const auto* camera = std::get_if<scene::Camera>(&object(child)); camera && is_moved)
                    move_camera(camera->name, world);
            }
        }
    }

    void show_or_hide(ObjectId id, Transform& transform, bool has_volume) {
        std::vector<ObjectId>& unseen = scene_.without_volume[id];
        const std::size_t unseen_before = unseen.size();
        if (has_volume) {
            transform.children.insert(transform.children.end(), unseen.begin(), unseen.end());
            unseen.clear();
        } else {
            const auto stays = [&](ObjectId child) {
                return !std::holds_alternative<Geometry>(object(child));
            };
            const auto gone =
                std::stable_partition(transform.children.begin(), transform.children.end(), stays);
            unseen.insert(unseen.end(), gone, transform.children.end());
            transform.children.erase(gone, transform.children.end());
        }
        if (unseen.size() != unseen_before) changed_[id] |= ChildrenBit;
        if (unseen.empty()) scene_.without_volume.erase(id);
    }

    // A camera whose transform is degenerate keeps its last pose.
    void move_camera(const std::string& name, glm::dmat4 world) {
        const auto camera = std::find_if(scene_.cameras.begin(), scene_.cameras.end(),
                                         [&](const CameraInfo& info) { return info.name == name; });
        if (camera != scene_.cameras.end() && make_rigid(world)) camera->world_from_camera = world;
    }

    ImportedScene& scene_;
    const Playback& playback_;
    double seconds_;
    Pose before_, now_;
    std::vector<Pose> samples_;  // while the shutter is open
    std::vector<std::pair<const DeformedGeometry*, MeshData>> deformed_;
    std::vector<std::pair<ObjectId, VertexKeys>> vertex_keys_;
    std::map<ObjectId, scene::FieldMask> changed_;
    std::map<Hash256, scene::BlobPtr> new_blobs_;
    std::set<ObjectId> moving_, ancestors_;  // moving transforms, and these with all their ancestors
    SceneUpdate update_;
};

}  // namespace

Expected<SceneUpdate> move_to(ImportedScene& scene, double seconds) {
    if (!scene.playback) return SceneUpdate{};
    try {
        PoseUpdate update(scene, seconds);
        update.deform();
        return update.apply();
    } catch (const Error& error) {
        return tl::unexpected<Error>(error);
    }
}

}  // namespace tessera::import
