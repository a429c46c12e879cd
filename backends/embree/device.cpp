#include "backends/embree/device.h"

#include <cpuid.h>

#include <array>
#include <cstring>

#include "mediator/frame/render_revision.h"

namespace tessera::embree {

namespace {

bool has_avx512() {
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
           __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512bw") &&
           __builtin_cpu_supports("avx512vl");
}

std::string instruction_set(const std::string& wanted) {
    if (!__builtin_cpu_supports("avx2")) {
        throw Error(ErrorCode::Unavailable, "the Embree back-end needs a CPU with AVX2: use another node");
    }
    if (wanted.empty()) return has_avx512() ? "avx512" : "avx2";
    if (wanted != "avx2" && wanted != "avx512") {
        throw Error(ErrorCode::InvalidInput,
                    "instruction set '" + wanted + "' is unknown: choose avx2 or avx512");
    }
    if (wanted == "avx512" && !has_avx512()) {
        throw Error(ErrorCode::Unavailable, "this CPU has no AVX-512: choose --isa avx2");
    }
    return wanted;
}

std::string cpu_vendor() {
    unsigned eax = 0, ebx = 0, ecx = 0, edx = 0;
    if (__get_cpuid(0, &eax, &ebx, &ecx, &edx) == 0) return "unknown";
    std::array<char, 13> text{};
    std::memcpy(text.data(), &ebx, 4);
    std::memcpy(text.data() + 4, &edx, 4);
    std::memcpy(text.data() + 8, &ecx, 4);
    return text.data();
}

const char* reason(RTCError error) {
    switch (error) {
        case RTC_ERROR_INVALID_ARGUMENT:
            return "invalid argument";
        case RTC_ERROR_INVALID_OPERATION:
            return "invalid operation";
        case RTC_ERROR_OUT_OF_MEMORY:
            return "out of memory";
        case RTC_ERROR_UNSUPPORTED_CPU:
            return "unsupported CPU";
        case RTC_ERROR_CANCELLED:
            return "cancelled";
        default:
            return "unknown error";
    }
}

}  // namespace

DeviceHandle make_device(const backend::BackendSettings& settings) {
    std::string config = "isa=" + instruction_set(settings.isa);
    if (settings.threads != 0) config += ",threads=" + std::to_string(settings.threads);
    DeviceHandle device(rtcNewDevice(config.c_str()));
    if (!device) {
        throw Error(ErrorCode::Unavailable, std::string("Embree cannot start (") +
                                                reason(rtcGetDeviceError(nullptr)) + ") with " + config);
    }
    if (rtcGetDeviceProperty(device.get(), RTC_DEVICE_PROPERTY_RAY_MASK_SUPPORTED) == 0) {
        throw Error(
            ErrorCode::Unavailable,
            "this Embree was built without ray masks, which layers of objects need: use another build");
    }
    return device;
}

std::string kind_of(const backend::BackendSettings& settings) {
    return frame::with_render_revision(std::string("embree-") + RTC_VERSION_STRING + "/" +
                                       instruction_set(settings.isa) + "/" + cpu_vendor() + "/g++-" +
                                       std::to_string(__GNUC__) + "." + std::to_string(__GNUC_MINOR__));
}

void check(RTCDevice device, const std::string& what) {
    const RTCError error = rtcGetDeviceError(device);
    if (error == RTC_ERROR_NONE) return;
    const ErrorCode code = error == RTC_ERROR_OUT_OF_MEMORY ? ErrorCode::OutOfMemory : ErrorCode::Internal;
    throw Error(code, "Embree: " + what + ": " + reason(error));
}

}  // namespace tessera::embree
