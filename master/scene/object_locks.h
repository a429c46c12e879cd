#pragma once

#include <map>
#include <string>
#include <vector>

#include "mediator/scene/scene.h"
#include "mediator/session/members.h"

namespace tessera::master {

// Objects that only one session may change. Locks end with their session or their object. Pure.
class ObjectLocks {
  public:
    // Locks all of them or none and returns why not. Locking again by the holder is allowed.
    std::vector<std::string> lock(SessionId session, const std::string& name,
                                  const std::vector<ObjectId>& objects, const scene::Scene& scene);
    void unlock(SessionId session, const std::vector<ObjectId>& objects);
    void release_all(SessionId session);
    void object_gone(ObjectId id) { locks_.erase(id); }
    void clear() { locks_.clear(); }

    // The holder's name if another session holds the lock; null: free.
    const std::string* held_by_other(ObjectId id, SessionId session) const;
    std::vector<session::ObjectLock> all() const;  // in id order

  private:
    struct Holder {
        SessionId session;
        std::string name;
    };
    std::map<ObjectId, Holder> locks_;
};

}  // namespace tessera::master
