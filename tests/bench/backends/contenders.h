#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "mediator/backend/backend.h"
#include "mediator/shading/asked_ray.h"

// What back-ends are compared by: the whole of them by their contract, and their traversal alone.
namespace tessera::bench {

enum class Question { Closest, Any };

// Bare traversal through one scene: no paths, no shading. Rays are cast by all that the contender has: cores
// or a device.
class RayCaster {
  public:
    virtual ~RayCaster() = default;

    // Gets ready to cast these rays, again and again.
    virtual void take(std::span<const shading::AskedRay> rays, Question question) = 0;
    virtual void cast() = 0;  // done when it returns
    // Of the last cast, by ray; instance = NoInstance where nothing was hit. Only the instance means anything
    // for Question::Any.
    virtual std::vector<shading::Hit> hits() const = 0;
};

struct Contender {
    std::string name;
    std::string summary;
    bool chooses_device = false;  // whether BackendSettings::device means anything to it
    // Both throw Error when they cannot start.
    std::function<std::unique_ptr<backend::Backend>(const backend::BackendSettings&)> make_backend;
    std::function<std::unique_ptr<RayCaster>(const backend::BackendSettings&,
                                             const scene::ChangeList& snapshot)>
        make_caster;
};

// Those that were built; the first is what others are compared with.
std::vector<Contender> contenders();

}  // namespace tessera::bench
