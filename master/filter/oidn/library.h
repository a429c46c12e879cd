#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "mediator/base/error.h"

// The C interface of Open Image Denoise, versions 1 and 2, as its documentation describes it. The library is opened when
// it is first needed: Tessera is neither linked to it nor shipped with it.
namespace tessera::filter::oidn {

// The functions that are used. Handles are opaque; names differ between versions where noted.
struct Functions {
    using Handle = void*;
    using Monitor = bool (*)(void* user, double progress);  // false: cancel

    Handle (*new_device)(int type);
    void (*set_device_int)(Handle device, const char* name, int value);  // Int, 1i in version 1
    int (*get_device_int)(Handle device, const char* name);              // Int, 1i in version 1
    int (*get_device_error)(Handle device, const char** message);        // clears it; of this thread
    void (*commit_device)(Handle device);
    void (*release_device)(Handle device);
    Handle (*new_filter)(Handle device, const char* type);
    void (*set_image)(Handle filter, const char* name, void* data, int format, std::size_t width,
                      std::size_t height, std::size_t byte_offset, std::size_t pixel_stride,
                      std::size_t row_stride);
    void (*set_filter_bool)(Handle filter, const char* name, bool value);  // Bool, 1b in version 1
    void (*set_monitor)(Handle filter, Monitor monitor, void* user);
    void (*commit_filter)(Handle filter);
    void (*execute_filter)(Handle filter);
    void (*release_filter)(Handle filter);
};

struct Library {
    Functions call{};
    std::string name;  // as it was opened
    int version = 0;   // 10000 major + 100 minor + patch
};

// The first of these shared libraries that is there. Unavailable: none is, or it lacks a function, is not of version 1 or
// 2, or creates no device for this CPU; the message says which, and what to do.
Expected<Library> open_library(std::span<const char* const> names);

// The installed library; it is searched for until it is found, so that it can be installed while the program runs.
// Stays open until the program ends.
Expected<const Library*> installed_library();

// A committed CPU device. Throws Error with the library's message.
class Device {
  public:
    // At most so many threads.
    Device(const Library& library, int threads);
    ~Device();
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;

    const Functions& call() const { return call_; }
    Functions::Handle handle() const { return handle_; }
    // What failed in the calls of this thread: throws Error, naming `action`. False: they were cancelled.
    bool check(const char* action) const;

  private:
    const Functions& call_;
    Functions::Handle handle_;
};

// The device of the installed library with so many threads, shared by all filters. Throws Error.
std::shared_ptr<Device> shared_device(int threads);

// The filter "RT" for HDR pictures, with noisy albedo and normals. Interleaved images of three floats per pixel, in raster
// order.
class RayTracingFilter {
  public:
    explicit RayTracingFilter(std::shared_ptr<Device> device);
    ~RayTracingFilter();
    RayTracingFilter(const RayTracingFilter&) = delete;
    RayTracingFilter& operator=(const RayTracingFilter&) = delete;

    // The images that every execution reads and writes, all of one size; they must outlive the filter or the next call.
    struct Images {
        std::vector<float>&color, &albedo, &normal, &output;
    };
    void set(const Images& images, std::size_t width, std::size_t height);

    // False: stopped; the output is undefined. Throws Error with the library's message.
    bool execute(const std::stop_token& stop);

  private:
    static bool goes_on(void* filter, double progress);

    std::shared_ptr<Device> device_;
    Functions::Handle handle_;
    std::stop_token stop_;
};

}  // namespace tessera::filter::oidn
