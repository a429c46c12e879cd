#pragma once

#include <map>
#include <string>
#include <vector>

#include "mediator/scene/scene.h"
#include "mediator/session/people.h"

namespace tessera::master {

// Who alone may change which objects. Locks go with their session or their object. Pure.
class ObjectLocks {
  public:
    // All of them or none; why not. Whoever holds a lock already may ask again.
    std::vector<std::string> lock(SessionId session, const std::string& name,
                                  const std::vector<ObjectId>& objects, const scene::Scene& scene);
    void unlock(SessionId session, const std::vector<ObjectId>& objects);
    void release_all(SessionId session);
    void object_gone(ObjectId id) { locks_.erase(id); }
    void clear() { locks_.clear(); }

    // The holder's name where it is another session; null: free.
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
