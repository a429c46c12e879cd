#pragma once

#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "master/peers/outbox.h"
#include "master/peers/session_table.h"
#include "master/scene/published_scene.h"
#include "master/scene/scene_encoder.h"

namespace tessera::master {

// Answers members who read the scene, each once it is at the version that has all edits made before the request. Members
// that read the same changes share the encoded bytes; long ones are encoded by another thread. Viewers get the cameras
// only.
class SceneReads {
  public:
    SceneReads(const PublishedScene& scene, SceneEncoder& encoder, scene::BlobStore& blobs,
               SessionTable& sessions, Outbox& outbox)
        : scene_(scene), encoder_(encoder), blobs_(blobs), sessions_(sessions), outbox_(outbox) {}

    // `wanted`: the version with all edits so far. Returns "" or the problem: a member reads once at a time.
    std::string read(const SessionRecord& session, const wire::ReadScene& request, Version wanted);
    void take(const EncodedScene& made);
    void tick();  // after every published version
    void left(SessionId session);
    void clear();
    // The content that the member was sent last: it may fetch this blob.
    bool may_fetch(SessionId session, const Hash256& blob) const;

  private:
    enum class Part : std::uint8_t { Everything, Cameras };
    struct Waiting {
        SessionId session;
        wire::ReadScene request;
        Version wanted;
        std::uint64_t job = 0;  // that encodes its answer; 0 = not started
    };
    // A list that is being encoded, or was.
    struct Encoded {
        std::uint64_t job = 0;
        Part part = Part::Everything;
        Version from, to;
        std::weak_ptr<const scene::Blob> blob;  // owned by those who were sent it
        bool is_done = false;
    };

    bool answer(Waiting& read);  // false: not yet
    void answer_now(const Waiting& read, const scene::ChangeList& list);
    void answer_by_blob(const Waiting& read, const scene::BlobPtr& blob);
    Encoded* find(Part part, Version from, Version to);
    Encoded* find(std::uint64_t job);
    void start(Waiting& read, Part part, Version from, std::function<scene::ChangeList()> make);

    const PublishedScene& scene_;
    SceneEncoder& encoder_;
    scene::BlobStore& blobs_;
    SessionTable& sessions_;
    Outbox& outbox_;
    std::vector<Waiting> waiting_;
    std::vector<Encoded> encoded_;
    std::map<SessionId, scene::BlobPtr> contents_;  // at most one each, until the next is sent
};

}  // namespace tessera::master
