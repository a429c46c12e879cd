#include "master/scene/scene_reads.h"

#include <algorithm>

#include "mediator/view/camera_scene.h"
#include "mediator/wire/envelope.h"

namespace tessera::master {

std::string SceneReads::read(const SessionRecord& session, const wire::ReadScene& request, Version wanted) {
    for (Waiting& waiting : waiting_) {
        if (waiting.session != session.id) continue;
        if (waiting.request.request == request.request) return {};  // sent again after a reconnection
        return "this client reads the scene already: wait for the answer";
    }
    waiting_.push_back({session.id, request, wanted});
    return {};
}

void SceneReads::tick() {
    std::erase_if(waiting_, [&](Waiting& read) {
        if (scene_.version().number < read.wanted.number) return false;
        return answer(read);
    });
}

SceneReads::Encoded* SceneReads::find(Part part, Version from, Version to) {
    for (Encoded& encoded : encoded_) {
        if (encoded.part == part && encoded.from == from && encoded.to == to) return &encoded;
    }
    return nullptr;
}

SceneReads::Encoded* SceneReads::find(std::uint64_t job) {
    const auto found =
        std::ranges::find_if(encoded_, [&](const Encoded& encoded) { return encoded.job == job; });
    return found == encoded_.end() ? nullptr : &*found;
}

void SceneReads::start(Waiting& read, Part part, Version from, std::function<scene::ChangeList()> make) {
    if (const Encoded* known = find(part, from, scene_.version())) {
        if (const scene::BlobPtr blob = known->blob.lock(); blob || !known->is_done) {
            read.job = known->job;
            return;
        }
    }
    std::erase_if(encoded_, [](const Encoded& encoded) { return encoded.is_done && encoded.blob.expired(); });
    const Version to = scene_.version();
    read.job = encoder_.encode(from, to, std::move(make));
    encoded_.push_back({.job = read.job, .part = part, .from = from, .to = to, .blob = {}});
}

bool SceneReads::answer(Waiting& read) {
    const SessionRecord* session = sessions_.find(read.session);
    if (session == nullptr) return true;
    if (read.job != 0) {
        const Encoded* encoded = find(read.job);
        if (encoded && !encoded->is_done) return false;
        const scene::BlobPtr blob = encoded ? encoded->blob.lock() : nullptr;
        if (blob) {
            answer_by_blob(read, blob);
            return true;
        }
        read.job = 0;  // its last reader left, or there was no memory for it
    }
    const Version version = scene_.version(), nothing{version.epoch, 0};
    if (session->role == net::Role::Viewer) {
        if (read.request.known == version) {
            answer_now(read, {.from = version, .to = version, .entries = {}, .state_hash = {}});
            return true;
        }
        const auto make = [scene = scene_.scene()] { return scene::snapshot(view::camera_scene(scene)); };
        if (scene_.scene().objects().size() <= SceneEncoder::ShortList) {
            answer_now(read, make());
            return true;
        }
        start(read, Part::Cameras, nothing, make);
    } else {
        const auto missed = scene_.since(read.request.known);
        const std::size_t size = missed ? missed->max_size() : scene_.scene().objects().size();
        if (size <= SceneEncoder::ShortList) {
            answer_now(read, missed ? missed->list() : scene_.snapshot());
            return true;
        }
        if (missed) {
            start(read, Part::Everything, read.request.known, [missed] { return missed->list(); });
        } else {
            start(read, Part::Everything, nothing,
                  [scene = scene_.scene()] { return scene::snapshot(scene); });
        }
    }
    // Encoded for another reader before.
    const Encoded* known = find(read.job);
    return known->is_done && answer(read);
}

void SceneReads::take(const EncodedScene& made) {
    Encoded* encoded = find(made.job);
    if (encoded == nullptr) return;
    encoded->is_done = true;
    const scene::BlobPtr blob = made.blob ? blobs_.insert(made.blob) : nullptr;
    encoded->blob = blob;
    std::erase_if(waiting_, [&](Waiting& read) {
        if (read.job != made.job) return false;
        if (blob) return answer(read);
        if (const SessionRecord* session = sessions_.find(read.session))
            outbox_.control(
                session->control,
                wire::RequestDone{read.request.request, false,
                                  "the master has no memory to encode the scene: try again later"});
        return true;
    });
}

void SceneReads::answer_now(const Waiting& read, const scene::ChangeList& list) {
    const SessionRecord* session = sessions_.find(read.session);
    net::Bytes message;
    if (wire::may_fit_control(list.entries.size()))
        message = wire::encode(wire::ControlMessage(
            wire::SceneContent{.request = read.request.request, .list = list, .blob = {}}));
    if (message.empty() || !wire::fits_control(message))
        return answer_by_blob(read, blobs_.insert(wire::encode(list)));
    outbox_.control(session->control, std::move(message));
}

void SceneReads::answer_by_blob(const Waiting& read, const scene::BlobPtr& blob) {
    const SessionRecord* session = sessions_.find(read.session);
    contents_[read.session] = blob;
    outbox_.control(
        session->control,
        wire::SceneContent{.request = read.request.request, .list = {}, .blob = scene::reference(*blob)});
}

void SceneReads::left(SessionId session) {
    std::erase_if(waiting_, [&](const Waiting& read) { return read.session == session; });
    contents_.erase(session);
}

void SceneReads::clear() {
    waiting_.clear();
    contents_.clear();
}

bool SceneReads::may_fetch(SessionId session, const Hash256& blob) const {
    const auto content = contents_.find(session);
    return content != contents_.end() && content->second->hash() == blob;
}

}  // namespace tessera::master
