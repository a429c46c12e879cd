#include "client/import/playback.h"

#include <algorithm>
#include <set>

#include "client/import/import.h"
#include "client/import/shutter.h"
#include "client/import/survey.h"
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

class Step {
  public:
    Step(ImportedScene& scene, double seconds)
        : scene_(scene),
          playback_(*scene.playback),
          seconds_(seconds),
          before_(playback_.motion.pose(scene.seconds)),
          now_(playback_.motion.pose(seconds)) {
        for (std::size_t i = 0; scene.shutter > 0.0 && i <= Looks; ++i) {
            looks_.push_back(playback_.motion.pose(seconds + scene.shutter * double(i) / double(Looks)));
        }
    }

    // Everything that may fail, before anything is changed.
    void bend() {
        for (const BendingGeometry& geometry : playback_.bending) {
            const auto node = static_cast<std::size_t>(geometry.node);
            const std::vector<glm::dmat4> joints = joints_of(geometry, now_);
            if (!looks_.empty()) look_at(geometry);
            if (now_.weights[node] == before_.weights[node] && joints == joints_of(geometry, before_))
                continue;
            bent_.emplace_back(&geometry, bent(geometry, now_));
        }
    }

    TimeStep apply() {
        move_transforms();
        for (const auto& [geometry, mesh] : bent_) set_arrays(geometry->geometry, mesh);
        for (const auto& [id, steps] : bending_) set_steps(id, steps);
        if (!bent_.empty() || !bending_.empty()) renew_blobs();
        look_around();
        if (!looks_.empty()) move_cameras(scene_);
        scene_.seconds = seconds_;
        for (const auto& [id, mask] : changed_)
            step_.entries.push_back(scene::Update{id, mask, scene::only(object(id), mask)});
        return std::move(step_);
    }

  private:
    struct Place {
        ObjectId transform;
        glm::dmat4 parent{1.0};
        bool is_moved = false;  // by a transform above
    };

    // A geometry's vertices while the shutter is open.
    struct Steps {
        std::vector<std::vector<glm::vec3>> positions, normals;
    };

    MeshData bent(const BendingGeometry& geometry, const Pose& pose) const {
        try {
            return import::bend(*geometry.mesh, pose.weights[static_cast<std::size_t>(geometry.node)],
                                joints_of(geometry, pose));
        } catch (const Error& error) {
            throw Error(error.code(), "mesh '" + geometry.name + "' at " + std::to_string(seconds_) +
                                          " s: " + error.what() + "; repair its animation");
        }
    }

    void look_at(const BendingGeometry& geometry) {
        std::vector<std::vector<glm::vec3>> positions, normals;
        for (const Pose& look : looks_) {
            MeshData mesh = bent(geometry, look);
            positions.push_back(std::move(mesh.positions));
            normals.push_back(std::move(mesh.normals));
        }
        Steps steps{steps_of(positions), {}};
        // Normals at the same times, where there are some.
        for (std::size_t i = 1; i <= steps.positions.size() && !normals.front().empty(); ++i) {
            steps.normals.push_back(std::move(normals[i * (Looks / steps.positions.size())]));
        }
        bending_.emplace_back(geometry.geometry, std::move(steps));
    }

    scene::Object& object(ObjectId id) {
        return scene_.objects[id.value - scene_.objects.front().id.value].object;
    }

    std::vector<glm::dmat4> joints_of(const BendingGeometry& geometry, const Pose& pose) const {
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
                leading_.insert(playback_.transforms[static_cast<std::size_t>(above)]);
            auto& transform = std::get<Transform>(object(id));
            std::vector<glm::dmat4> looks;
            for (const Pose& look : looks_) looks.push_back(look.local[i]);
            if (std::vector<glm::dmat4> steps = steps_of(looks); transform.motion != steps) {
                transform.motion = std::move(steps);
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
        made_.emplace(blob->hash(), std::move(blob));
    }

    void set_steps(ObjectId id, const Steps& steps) {
        auto& geometry = std::get<Geometry>(object(id));
        set_list(id, geometry.motion_positions, steps.positions, &Geometry::motion_positions);
        set_list(id, geometry.motion_normals, steps.normals, &Geometry::motion_normals);
    }

    void set_list(ObjectId id, std::vector<scene::BlobRef>& references,
                  const std::vector<std::vector<glm::vec3>>& steps, scene::Fields<Geometry> field) {
        std::vector<scene::BlobRef> now;
        for (const std::vector<glm::vec3>& step : steps) {
            auto blob = std::make_shared<const scene::Blob>(std::as_bytes(std::span(step)));
            now.push_back(scene::reference(*blob));
            made_.emplace(blob->hash(), std::move(blob));
        }
        if (now == references) return;
        references = std::move(now);
        changed_[id] |= field.bits();
    }

    // Those of the time before go, unless something else has them, too.
    void renew_blobs() {
        std::set<Hash256> wanted;
        for (const scene::Create& create : scene_.objects) {
            for (const scene::BlobRef& blob : scene::referenced_blobs(create.object))
                wanted.insert(blob.hash);
        }
        std::erase_if(scene_.blobs, [&](const auto& blob) { return !wanted.contains(blob->hash()); });
        for (const scene::BlobPtr& blob : scene_.blobs) made_.erase(blob->hash());
        for (auto& [unused, blob] : made_) {
            step_.blobs.push_back(blob);
            scene_.blobs.push_back(std::move(blob));
        }
    }

    // Where something moved: geometries come and go with the volume that transforms leave them, cameras are
    // elsewhere.
    void look_around() {
        std::vector<Place> stack;
        for (const ObjectId child : scene_.root.children) stack.push_back({child});
        while (!stack.empty()) {
            const Place place = stack.back();
            stack.pop_back();
            auto* transform = std::get_if<Transform>(&object(place.transform));
            if (transform == nullptr || !(place.is_moved || leading_.contains(place.transform))) continue;
            const bool is_moved = place.is_moved || moving_.contains(place.transform);
            const glm::dmat4 world = place.parent * transform->matrix;
            if (is_moved) show_or_hide(place.transform, *transform, has_volume(world));
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

    // One without a direction stays where it was.
    void move_camera(const std::string& name, glm::dmat4 world) {
        const auto camera = std::find_if(scene_.cameras.begin(), scene_.cameras.end(),
                                         [&](const CameraInfo& info) { return info.name == name; });
        if (camera != scene_.cameras.end() && make_rigid(world)) camera->world_from_camera = world;
    }

    ImportedScene& scene_;
    const Playback& playback_;
    double seconds_;
    Pose before_, now_;
    std::vector<Pose> looks_;  // while the shutter is open
    std::vector<std::pair<const BendingGeometry*, MeshData>> bent_;
    std::vector<std::pair<ObjectId, Steps>> bending_;
    std::map<ObjectId, scene::FieldMask> changed_;
    std::map<Hash256, scene::BlobPtr> made_;
    std::set<ObjectId> moving_, leading_;  // transforms: that move; on the way from the root to one
    TimeStep step_;
};

}  // namespace

Expected<TimeStep> move_to(ImportedScene& scene, double seconds) {
    if (!scene.playback) return TimeStep{};
    try {
        Step step(scene, seconds);
        step.bend();
        return step.apply();
    } catch (const Error& error) {
        return tl::unexpected<Error>(error);
    }
}

}  // namespace tessera::import
