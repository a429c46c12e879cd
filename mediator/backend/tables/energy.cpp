#include "mediator/shading/energy.h"

#include "mediator/backend/tables/tables.h"

namespace tessera::backend {

std::span<const float> energy_values() {
    static constexpr float Numbers[] = {
#include "energy_values.inc"
    };
    static_assert(std::size(Numbers) == shading::EnergyCount);
    return Numbers;
}

}  // namespace tessera::backend
