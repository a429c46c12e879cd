#include "mediator/filter/planes.h"

namespace tessera::filter {

frame::Image interleaved(const Planes& planes) {
    frame::Image image(planes.width(), planes.height(), planes.components());
    for (std::uint32_t c = 0; c < planes.components(); ++c) {
        const std::span<const float> plane = planes.plane(c);
        for (std::size_t i = 0; i < plane.size(); ++i) image.values[i * planes.components() + c] = plane[i];
    }
    return image;
}

}  // namespace tessera::filter
