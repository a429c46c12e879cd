// A stand-in for Open Image Denoise: the part of its C interface that Tessera calls, written from its documentation, with a
// known operation in place of the network. Each pixel becomes the mean of those of the 5 x 5 around it whose albedo and
// normal are like its own. It checks that it is called as documented. TESSERA_OIDN_FAILS names what fails,
// or what is wrong with the picture.
#include "tests/oidn/stand_in.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <limits>
#include <mutex>
#include <utility>

#ifndef STAND_IN_VERSION
#define STAND_IN_VERSION 20301
#endif

namespace {

struct Device {
    bool committed = false;
    int threads = 0;
};

struct Image {
    float* values = nullptr;
    std::size_t width = 0, height = 0;
    bool operator==(const Image&) const = default;
};

struct Filter {
    Device* device;
    Image color, albedo, normal, output;
    bool hdr = false, committed = false;
    bool (*monitor)(void*, double) = nullptr;
    void* user = nullptr;
};

// The first error of this thread since it was asked for.
thread_local int first_error = 0;
thread_local const char* first_message = nullptr;

void fail(int code, const char* message) {
    if (first_error != 0) return;
    first_error = code;
    first_message = message;
}

std::nullptr_t no_object(int code, const char* message) {
    fail(code, message);
    return nullptr;
}

constexpr int Unknown = 1, InvalidArgument = 2, InvalidOperation = 3, OutOfMemory = 4, Unsupported = 5,
              Cancelled = 6;

bool fails(const char* what) {
    const char* named = std::getenv("TESSERA_OIDN_FAILS");
    return named != nullptr && std::strcmp(named, what) == 0;
}

bool alike(const Filter& f, std::size_t a, std::size_t b) {
    for (std::size_t c = 0; c < 3; ++c) {
        if (std::fabs(f.albedo.values[3 * a + c] - f.albedo.values[3 * b + c]) >
                tessera::test::StandInRange ||
            std::fabs(f.normal.values[3 * a + c] - f.normal.values[3 * b + c]) > tessera::test::StandInRange)
            return false;
    }
    return true;
}

[[maybe_unused]] void filter_pixel(const Filter& f, std::size_t x, std::size_t y) {
    constexpr std::size_t Radius = tessera::test::StandInRadius;
    const std::size_t width = f.color.width, height = f.color.height, own = y * width + x;
    double sums[3] = {}, count = 0.0;
    for (std::size_t j = y - std::min(y, Radius); j <= std::min(height - 1, y + Radius); ++j) {
        for (std::size_t i = x - std::min(x, Radius); i <= std::min(width - 1, x + Radius); ++i) {
            const std::size_t other = j * width + i;
            if (!alike(f, own, other)) continue;
            for (std::size_t c = 0; c < 3; ++c) sums[c] += f.color.values[3 * other + c];
            count += 1.0;
        }
    }
    for (std::size_t c = 0; c < 3; ++c) f.output.values[3 * own + c] = static_cast<float>(sums[c] / count);
}

#if STAND_IN_VERSION >= 20000
#define SET_DEVICE_INT oidnSetDeviceInt
#define GET_DEVICE_INT oidnGetDeviceInt
#define SET_FILTER_BOOL oidnSetFilterBool
#else
#define SET_DEVICE_INT oidnSetDevice1i
#define GET_DEVICE_INT oidnGetDevice1i
#define SET_FILTER_BOOL oidnSetFilter1b
#endif
#define EXPORTED extern "C" __attribute__((visibility("default")))

}  // namespace

EXPORTED void* oidnNewDevice(int type) {
    if (type != 1) return no_object(InvalidArgument, "only the CPU can read the memory of its caller");
    if (fails("device")) return no_object(Unsupported, "unsupported device type: CPU");
    // Kept, since those that could not be committed are not released.
    static std::mutex mutex;
    static std::deque<Device> devices;
    const std::lock_guard lock(mutex);
    return &devices.emplace_back();
}

EXPORTED void oidnReleaseDevice(void* device) {
    if (!static_cast<Device*>(device)->committed) std::abort();  // as some versions do
}

EXPORTED void SET_DEVICE_INT(void* device, const char* name, int value) {
    if (std::strcmp(name, "numThreads") != 0) return fail(InvalidArgument, "unknown device parameter");
    static_cast<Device*>(device)->threads = value;
}

EXPORTED int GET_DEVICE_INT(void*, const char* name) {
    return std::strcmp(name, "version") == 0 ? STAND_IN_VERSION : 0;
}

EXPORTED int oidnGetDeviceError(void*, const char** message) {
    if (message != nullptr) *message = first_message;
    first_message = nullptr;
    return std::exchange(first_error, 0);
}

EXPORTED void oidnCommitDevice(void* device) {
    Device& d = *static_cast<Device*>(device);
    if (fails("commit device")) return fail(Unknown, "the device is lost");
    if (d.committed) return fail(InvalidOperation, "a device is committed once");
    if (d.threads < 1) return fail(InvalidArgument, "no thread may be used");
    d.committed = true;
}

EXPORTED void* oidnNewFilter(void* device, const char* type) {
    Device& d = *static_cast<Device*>(device);
    if (fails("filter")) return no_object(OutOfMemory, "out of memory");
    if (!d.committed) return no_object(InvalidOperation, "changes to the device are not committed");
    if (std::strcmp(type, "RT") != 0) return no_object(InvalidArgument, "unknown filter type");
    return new Filter{.device = &d};
}

EXPORTED void oidnReleaseFilter(void* filter) {
    delete static_cast<Filter*>(filter);
}

EXPORTED void oidnSetSharedFilterImage(void* filter, const char* name, void* data, int format,
                                       std::size_t width, std::size_t height, std::size_t offset,
                                       std::size_t pixel_stride, std::size_t row_stride) {
    Filter& f = *static_cast<Filter*>(filter);
    Image* const image = std::strcmp(name, "color") == 0    ? &f.color
                         : std::strcmp(name, "albedo") == 0 ? &f.albedo
                         : std::strcmp(name, "normal") == 0 ? &f.normal
                         : std::strcmp(name, "output") == 0 ? &f.output
                                                            : nullptr;
    if (image == nullptr || format != 3 || offset != 0 || pixel_stride != 0 || row_stride != 0)
        return fail(InvalidArgument, "an image is not of three floats, or its name is unknown");
    *image = {static_cast<float*>(data), width, height};
    f.committed = false;
}

EXPORTED void SET_FILTER_BOOL(void* filter, const char* name, bool value) {
    Filter& f = *static_cast<Filter*>(filter);
    if (std::strcmp(name, "hdr") != 0) return fail(InvalidArgument, "unknown filter parameter");
    f.hdr = value;
    f.committed = false;
}

EXPORTED void oidnSetFilterProgressMonitorFunction(void* filter, bool (*monitor)(void*, double), void* user) {
    Filter& f = *static_cast<Filter*>(filter);
    f.monitor = monitor;
    f.user = user;
}

EXPORTED void oidnCommitFilter(void* filter) {
    Filter& f = *static_cast<Filter*>(filter);
    if (fails("commit filter")) return fail(OutOfMemory, "out of memory");
    const auto same_size = [&](const Image& image) {
        return image.values != nullptr && image.width == f.output.width && image.height == f.output.height;
    };
    if (!same_size(f.color) || !same_size(f.albedo) || !same_size(f.normal) || !same_size(f.output))
        return fail(InvalidOperation, "an image is missing or of another size");
    f.committed = true;
}

#ifndef STAND_IN_LACKS_EXECUTE
EXPORTED void oidnExecuteFilter(void* filter) {
    const Filter& f = *static_cast<Filter*>(filter);
    if (fails("execute")) return fail(Unknown, "the network is lost");
    if (!f.committed) return fail(InvalidOperation, "changes to the filter are not committed");
    if (!f.hdr) return fail(InvalidOperation, "the picture is not HDR");
    for (std::size_t y = 0; y < f.color.height; ++y) {
        const double progress = static_cast<double>(y) / static_cast<double>(f.color.height);
        if (f.monitor != nullptr && !f.monitor(f.user, progress))
            return fail(Cancelled, "execution was cancelled");
        for (std::size_t x = 0; x < f.color.width; ++x) filter_pixel(f, x, y);
    }
    if (fails("dim")) {
        for (std::size_t i = 0; i < 3 * f.output.width * f.output.height; ++i) f.output.values[i] *= 0.99f;
    }
    if (fails("nan")) f.output.values[0] = std::numeric_limits<float>::quiet_NaN();
}
#endif
