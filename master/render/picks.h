#pragma once

#include <functional>
#include <glm/vec3.hpp>
#include <list>

#include "master/peers/session_table.h"
#include "master/render/pass_starter.h"

namespace tessera::master {

// Finds the object under a pixel, with one sample of a view of the pixel's centre only.
class Picks {
  public:
    // `name_of`: the name of an object of the scene.
    Picks(ViewIds& ids, PassStarter& passes, SessionTable& sessions, Outbox& outbox,
          std::function<std::string(ObjectId)> name_of)
        : ids_(ids), passes_(passes), sessions_(sessions), outbox_(outbox), name_of_(std::move(name_of)) {}

    // `seen`: the view that the session watches under this number; null: none.
    void pick(SessionId session, const wire::Pick& request, const view::View* seen, Version version);
    void session_left(SessionId session);
    void close_all();
    void follow(Version version);  // the scene has another version

    bool empty() const { return tasks_.empty(); }
    void deal(std::vector<NodeCapacity>& capacities, TimePoint now);
    void tick();                        // requests the films of complete picks
    bool take(const FilmBlocks& film);  // false: not of a pick

  private:
    struct Task {
        SessionId session;
        wire::Pick request;
        Version version;
        Pass pass;
        glm::dvec3 eye{0.0}, direction{0.0};
        double along_axis = 1.0;  // distance along the ray = depth along the view's axis x this
        bool copied = false;
    };
    void aim(Task& task, const view::View& seen) const;
    void answer(const Task& task, const frame::FilmTile& film);
    void refuse(const Task& task, const std::string& problem);

    ViewIds& ids_;
    PassStarter& passes_;
    SessionTable& sessions_;
    Outbox& outbox_;
    std::function<std::string(ObjectId)> name_of_;
    std::list<Task> tasks_;
};

}  // namespace tessera::master
