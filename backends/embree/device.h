#pragma once

#include <embree3/rtcore.h>

#include <memory>
#include <string>
#include <type_traits>

#include "mediator/backend/backend.h"

namespace tessera::embree {

template <auto Release>
struct Releaser {
    template <class T>
    void operator()(T* handle) const {
        Release(handle);
    }
};
using DeviceHandle = std::unique_ptr<RTCDeviceTy, Releaser<rtcReleaseDevice>>;
using SceneHandle = std::unique_ptr<RTCSceneTy, Releaser<rtcReleaseScene>>;
using GeometryHandle = std::unique_ptr<RTCGeometryTy, Releaser<rtcReleaseGeometry>>;

// Throws Error when the CPU lacks the requested instruction set.
DeviceHandle make_device(const backend::BackendSettings& settings);

// "embree-3.13.5/avx512/GenuineIntel/g++-12.2/r1": must be equal for equal bits.
std::string kind_of(const backend::BackendSettings& settings);

// Throws Error with Embree's reason if a call failed since the last check.
void check(RTCDevice device, const std::string& what);

}  // namespace tessera::embree
