#pragma once

#include <glm/gtc/matrix_transform.hpp>
#include <initializer_list>
#include <stdexcept>
#include <utility>
#include <vector>

#include "mediator/scene/fields.h"
#include "mediator/scene/scene.h"

namespace tessera::test {

inline glm::dmat4 moved(double x, double y, double z) {
    return glm::translate(glm::dmat4(1.0), glm::dvec3(x, y, z));
}

inline scene::Transform transform(const glm::dmat4& matrix, std::vector<ObjectId> children) {
    return {.name = {}, .matrix = matrix, .children = std::move(children)};
}

// Builds a scene by change lists, each to the next version, like those sent to a replica.
class SceneBuilder {
  public:
    SceneBuilder() { scene_.set_version({1, 0}); }

    // Applies the entries and returns their change list.
    scene::ChangeList edit(std::vector<scene::Entry> entries) {
        scene::ChangeList list{
            scene_.version(), {scene_.version().epoch, scene_.version().number + 1}, std::move(entries), {}};
        if (const auto done = scene_.apply_entries(list.entries); !done)
            throw std::logic_error(done.error().what());
        scene_.set_version(list.to);
        list.state_hash = scene_.state_hash();
        return list;
    }

    scene::ChangeList move(ObjectId id, const glm::dmat4& matrix) {
        return edit({update<scene::Transform>(id, &scene::Transform::matrix, transform(matrix, {}))});
    }

    template <class T>
    static scene::Update update(ObjectId id, scene::Fields<T> mask, const T& fields) {
        return {id, mask.bits(), scene::Object(fields)};
    }

    const scene::Scene& scene() const { return scene_; }

  private:
    scene::Scene scene_;
};

}  // namespace tessera::test
