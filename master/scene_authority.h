#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mediator/scene/scene.h"

namespace tessera::master {

// Owns the scene, numbers its versions and alone makes change lists. Pure: no sockets, no time.
class SceneAuthority {
  public:
    // `epoch` is new at every start of a master and never 0.
    SceneAuthority(std::uint64_t epoch, std::shared_ptr<scene::BlobStore> blobs);

    struct IdRange {
        std::uint64_t first = 0, count = 0;
        bool contains(ObjectId id) const { return id.value >= first && id.value - first < count; }
    };
    IdRange lend_ids(SessionId session);  // the same again for the same session

    struct Answer {
        bool accepted = false;
        Version version;                           // that holds the edit
        std::vector<std::string> problems;         // why not
        std::optional<scene::ChangeList> changes;  // new; empty for a resent edit or one that changes nothing
    };
    // All blobs must be in the store. An edit resent (same session and sequence) gets its first answer again.
    Answer submit(const scene::Edit& edit);

    // Back to the empty scene: what a batch leaves behind. Empty when nothing was there.
    std::optional<scene::ChangeList> clear();

    // Moves the render origin to the camera's cell, if the camera has left the neighbourhood of the present
    // one.
    std::optional<scene::ChangeList> follow_camera(const glm::dvec3& camera_position);

    const scene::Scene& scene() const { return scene_; }
    Version version() const { return scene_.version(); }
    scene::ChangeList snapshot() const { return scene::snapshot(scene_); }
    // Blobs the edit needs and the store lacks.
    std::vector<scene::BlobRef> missing_blobs(const scene::Edit& edit) const;
    void forget(SessionId session);

  private:
    std::optional<scene::ChangeList> advance(std::vector<scene::Entry> entries);

    std::shared_ptr<scene::BlobStore> blobs_;
    scene::Scene scene_;
    std::uint64_t next_id_;
    struct SessionState {
        IdRange ids;
        std::uint64_t last_sequence = 0;
        Answer last_answer;
    };
    std::map<SessionId, SessionState> sessions_;
};

// Cells of 256 m: within one, float32 resolves 2^-16 m (15 micrometres).
inline constexpr double RenderOriginCell = 256.0;

}  // namespace tessera::master
