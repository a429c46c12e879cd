#include "master/filter/oidn/library.h"

#include <dlfcn.h>

#include <array>
#include <mutex>
#include <utility>

namespace tessera::filter::oidn {

namespace {

// Values of the enumerations of the interface, the same in both versions.
constexpr int DeviceTypeCpu = 1;  // shares its memory with the caller, which other devices need not
constexpr int FormatFloat3 = 3;
constexpr int NoError = 0, ErrorOutOfMemory = 4, ErrorCancelled = 6;

// Version 1 has the number 0, and 1 in some packages; without a number it may be any version.
constexpr std::array<const char*, 4> FileNames{"libOpenImageDenoise.so.2", "libOpenImageDenoise.so.1",
                                               "libOpenImageDenoise.so.0", "libOpenImageDenoise.so"};
constexpr const char* Remedy =
    "install Open Image Denoise 1 or 2 where the dynamic linker finds it (ldconfig, LD_LIBRARY_PATH), or "
    "choose another filter";

std::string text_of(int version) {
    return std::to_string(version / 10000) + "." + std::to_string(version / 100 % 100) + "." +
           std::to_string(version % 100);
}

// Finds functions by name and remembers the first that is missing.
class Symbols {
  public:
    explicit Symbols(void* library) : library_(library) {}

    // Under the first of the names that the library has.
    template <class Function>
    void find(Function& function, std::initializer_list<const char*> names) {
        for (const char* name : names) {
            function = reinterpret_cast<Function>(::dlsym(library_, name));
            if (function != nullptr) return;
        }
        if (missing_.empty()) missing_ = *names.begin();
    }
    const std::string& missing() const { return missing_; }

  private:
    void* library_;
    std::string missing_;
};

std::string find_all(void* library, Functions& call) {
    Symbols symbols(library);
    symbols.find(call.new_device, {"oidnNewDevice"});
    symbols.find(call.set_device_int, {"oidnSetDeviceInt", "oidnSetDevice1i"});
    symbols.find(call.get_device_int, {"oidnGetDeviceInt", "oidnGetDevice1i"});
    symbols.find(call.get_device_error, {"oidnGetDeviceError"});
    symbols.find(call.commit_device, {"oidnCommitDevice"});
    symbols.find(call.release_device, {"oidnReleaseDevice"});
    symbols.find(call.new_filter, {"oidnNewFilter"});
    symbols.find(call.set_image, {"oidnSetSharedFilterImage"});
    symbols.find(call.set_filter_bool, {"oidnSetFilterBool", "oidnSetFilter1b"});
    symbols.find(call.set_monitor, {"oidnSetFilterProgressMonitorFunction"});
    symbols.find(call.commit_filter, {"oidnCommitFilter"});
    symbols.find(call.execute_filter, {"oidnExecuteFilter"});
    symbols.find(call.release_filter, {"oidnReleaseFilter"});
    return symbols.missing();
}

// Why there is no device: of this handle, or that none was created if it is null. "" if there is one.
std::string device_problem(const Functions& call, void* device) {
    const char* message = nullptr;
    const int code = call.get_device_error(device, &message);
    if (device != nullptr && code == NoError) return {};
    return "it creates no device for this CPU: " +
           (code != NoError && message != nullptr ? std::string(message) : "no reason is given");
}

// A device that could not be committed is not released: some versions then wait for what it does not have.
void start_device(const Functions& call, void* device, int threads) {
    call.set_device_int(device, "numThreads", threads);
    call.commit_device(device);
}

// Why the library cannot be used; "" and its version if it can. A device is created, since a master would otherwise
// accept views whose first picture fails.
std::string problem_of(const Functions& call, int& version) {
    void* const device = call.new_device(DeviceTypeCpu);
    if (device == nullptr) return device_problem(call, nullptr);
    start_device(call, device, 1);
    version = call.get_device_int(device, "version");
    if (std::string problem = device_problem(call, device); !problem.empty()) return problem;
    call.release_device(device);
    const int major = version / 10000;
    return major == 1 || major == 2 ? std::string() : "it is version " + text_of(version) + ", not 1 or 2";
}

}  // namespace

Expected<Library> open_library(std::span<const char* const> names) {
    const auto unusable = [](const std::string& why) {
        return failure(
            ErrorCode::Unavailable,
            "filter 'oidn' needs Open Image Denoise on the machine that filters, and " + why + ": " + Remedy);
    };
    for (const char* name : names) {
        const std::string found = std::string(name) + " cannot be used there: ";
        void* const opened = ::dlopen(name, RTLD_NOW | RTLD_LOCAL);
        if (opened == nullptr) {
            const char* error = ::dlerror();
            const std::string why = error != nullptr ? error : "it cannot be opened";
            // Another name is that of a library which this one needs.
            if (why.starts_with(std::string(name) + ": cannot open shared object file: No such file"))
                continue;
            return unusable(found + why);
        }
        Library library{.name = name};
        if (const std::string missing = find_all(opened, library.call); !missing.empty()) {
            ::dlclose(opened);
            return unusable(found + "it lacks the function " + missing);
        }
        // From here on it stays open: it may have started threads.
        const std::string problem = problem_of(library.call, library.version);
        if (!problem.empty()) return unusable(found + problem);
        return library;
    }
    return unusable("it is not installed there");
}

Expected<const Library*> installed_library() {
    static std::mutex mutex;
    static const Library* known = nullptr;  // never deleted: filters may outlive other static objects
    const std::lock_guard lock(mutex);
    if (known == nullptr) {
        auto library = open_library(FileNames);
        if (!library) return tl::unexpected(library.error());
        known = std::make_unique<const Library>(std::move(*library)).release();
    }
    return known;
}

Device::Device(const Library& library, int threads)
    : call_(library.call), handle_(call_.new_device(DeviceTypeCpu)) {
    if (handle_ == nullptr)
        throw Error(ErrorCode::Unavailable,
                    library.name + " cannot be used: " + device_problem(call_, nullptr));
    start_device(call_, handle_, threads);
    check("start its device");
}

Device::~Device() {
    call_.release_device(handle_);
}

bool Device::check(const char* action) const {
    const char* message = nullptr;
    const int code = call_.get_device_error(handle_, &message);
    if (code == NoError) return true;
    if (code == ErrorCancelled) return false;
    throw Error(code == ErrorOutOfMemory ? ErrorCode::OutOfMemory : ErrorCode::Unavailable,
                std::string("Open Image Denoise cannot ") + action + ": " +
                    (message != nullptr ? message : "no reason is given") + " (error " +
                    std::to_string(code) + ")");
}

std::shared_ptr<Device> shared_device(int threads) {
    static std::mutex mutex;
    static std::weak_ptr<Device> latest;
    static int latest_threads = 0;
    const auto library = installed_library();
    if (!library) throw library.error();
    const std::lock_guard lock(mutex);
    std::shared_ptr<Device> device = latest.lock();
    if (!device || latest_threads != threads) {
        device = std::make_shared<Device>(**library, threads);
        latest = device;
        latest_threads = threads;
    }
    return device;
}

RayTracingFilter::RayTracingFilter(std::shared_ptr<Device> device)
    : device_(std::move(device)), handle_(device_->call().new_filter(device_->handle(), "RT")) {
    if (handle_ != nullptr) return;
    device_->check("create its filter");
    throw Error(ErrorCode::Unavailable, "Open Image Denoise cannot create its filter: no reason is given");
}

RayTracingFilter::~RayTracingFilter() {
    device_->call().release_filter(handle_);
}

void RayTracingFilter::set(const Images& images, std::size_t width, std::size_t height) {
    const Functions& call = device_->call();
    const auto set_image = [&](const char* name, std::vector<float>& image) {
        call.set_image(handle_, name, image.data(), FormatFloat3, width, height, 0, 0, 0);
    };
    set_image("color", images.color);
    set_image("albedo", images.albedo);
    set_image("normal", images.normal);
    set_image("output", images.output);
    call.set_filter_bool(handle_, "hdr", true);
    call.set_monitor(handle_, &RayTracingFilter::goes_on, this);
    call.commit_filter(handle_);
    device_->check("prepare its filter");
}

bool RayTracingFilter::goes_on(void* filter, double) {
    return !static_cast<const RayTracingFilter*>(filter)->stop_.stop_requested();
}

bool RayTracingFilter::execute(const std::stop_token& stop) {
    stop_ = stop;
    device_->call().execute_filter(handle_);
    return device_->check("filter the picture");
}

}  // namespace tessera::filter::oidn
