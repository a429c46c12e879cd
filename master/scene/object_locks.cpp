#include "master/scene/object_locks.h"

#include "master/scene/transaction_text.h"

namespace tessera::master {

namespace {
constexpr std::size_t MaxLockProblems = 20;
}

std::vector<std::string> ObjectLocks::lock(SessionId session, const std::string& name,
                                           const std::vector<ObjectId>& objects, const scene::Scene& scene) {
    std::vector<std::string> problems;
    for (const ObjectId id : objects) {
        if (problems.size() == MaxLockProblems) break;
        const scene::Object* object = scene.find(id);
        if (object == nullptr) {
            problems.push_back("object " + std::to_string(id.value) +
                               " is not there: it cannot be locked; read the scene again");
        } else if (const std::string* holder = held_by_other(id, session)) {
            problems.push_back(object_path(id, *object) + " is locked by " + *holder + ": ask them for it");
        }
    }
    if (!problems.empty()) return problems;
    for (const ObjectId id : objects) locks_[id] = {session, name};
    return {};
}

void ObjectLocks::unlock(SessionId session, const std::vector<ObjectId>& objects) {
    for (const ObjectId id : objects) {
        const auto place = locks_.find(id);
        if (place != locks_.end() && place->second.session == session) locks_.erase(place);
    }
}

void ObjectLocks::release_all(SessionId session) {
    std::erase_if(locks_, [&](const auto& entry) { return entry.second.session == session; });
}

const std::string* ObjectLocks::held_by_other(ObjectId id, SessionId session) const {
    const auto place = locks_.find(id);
    return place == locks_.end() || place->second.session == session ? nullptr : &place->second.name;
}

std::vector<session::ObjectLock> ObjectLocks::all() const {
    std::vector<session::ObjectLock> list;
    for (const auto& [id, holder] : locks_) list.push_back({id, holder.name});
    return list;
}

}  // namespace tessera::master
