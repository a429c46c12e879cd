#pragma once

#include "mediator/backend/backend.h"

namespace tessera::vulkan {

backend::BackendEntry entry();

}  // namespace tessera::vulkan
