#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include "mediator/base/error.h"
#include "mediator/frame/film_tile.h"
#include "mediator/scene/blob.h"
#include "mediator/scene/scene.h"
#include "mediator/view/view.h"
#include "mediator/view/work_unit.h"

// The interface of a rendering back-end: change lists of the scene in, sample statistics out. It has no access to
// the network, other nodes, windows or files. A sample is a pure function of (scene content, view, pixel, sample
// index).
namespace tessera::backend {

struct Capabilities {
    frame::ChannelSet channels;
    view::RendererSet renderers = view::TracingRenderers;
    std::uint32_t preferred_tile = 32;   // pixels, edge of a square
    std::uint32_t concurrent_units = 1;  // number of render() calls to run in parallel
    bool deterministic = true;
    std::string
        kind;  // back-end, build, instruction set or device, render revision: equal kinds give equal bits
};

struct EditReport {
    std::uint32_t entries = 0, relevant = 0;
    std::uint32_t rebuilt =
        0;  // geometries whose acceleration structure was rebuilt (not read from the cache)
    std::uint32_t refitted = 0;                              // geometries refitted in place
    std::uint32_t retransformed = 0;                         // instances whose transform changed
    std::uint64_t triangles = 0, instances = 0, lights = 0;  // of the scene after the edit
    std::uint64_t degenerate_triangles = 0;                  // counted and skipped
    std::uint64_t uploaded_bytes = 0;                        // by this edit, to a device with separate memory
    std::vector<std::string> ignored_kinds;                  // object kinds this back-end does not draw
    // Objects drawn as placeholders, with the reason, each once per content; damaged files of the cache folder.
    std::vector<std::string> problems;
};

// An edit in progress; no render runs during its lifetime. Destroying it without commit() restores the last good
// version.
class EditScope {
  public:
    virtual ~EditScope() = default;
    // Any number of consecutive lists, each with the scene that results from it; the back-end keeps a copy (which
    // shares the objects). All referenced blobs are in the store. InvalidInput: wrong `from`.
    virtual Expected<void> apply(const scene::ChangeList& changes, const scene::Scene& after) = 0;
    // The same for callers without a scene. InvalidInput also for whatever Scene::apply rejects.
    Expected<void> apply(const scene::ChangeList& changes);
    virtual const scene::Scene& scene() const = 0;  // after the lists so far
    // Updates the device structures, each at the lowest sufficient cost. Call once. After an
    // error the last good version stays; OutOfMemory: the device is out of memory.
    virtual Expected<EditReport> commit() = 0;
};

enum class RenderStatus {
    Done,     // one block, that of the unit
    Stopped,  // the samples completed so far, as maximal aligned blocks; possibly none
    Refused,  // the unit is for another scene version
};

struct RenderResult {
    RenderStatus status = RenderStatus::Refused;
    std::vector<frame::FilmTile> blocks;
    std::uint64_t rays = 0;
};

class Backend {
  public:
    virtual ~Backend() = default;

    virtual Capabilities capabilities() const = 0;
    virtual Version version() const = 0;
    virtual std::unique_ptr<EditScope> begin_edit() = 0;  // waits until no render runs

    // Thread-safe: several units at a time. Completes a sample for the whole tile before it starts the next, so that
    // whole aligned blocks are left when it is stopped; returns within 50 ms of the stop. Never throws because of
    // scene content; throws Error for device failures and for a renderer that is not among its capabilities. The bits of the
    // film do not depend on the caller's floating-point mode.
    virtual RenderResult render(const view::View& view, const view::WorkUnit& unit, std::stop_token stop) = 0;

    // Traces one sample again and returns a log of its path, one line per vertex; the film is not touched.
    virtual std::vector<std::string> probe(const view::View& view, std::uint32_t x, std::uint32_t y,
                                           std::uint64_t sample) = 0;
};

// Throws Error{Refused} with the remedy if the view's renderer is not in the set.
void require_renderer(view::RendererSet available, const view::View& view);

struct BackendSettings {
    std::uint32_t threads = 0;           // 0 = all cores
    std::string isa;                     // "" = best, "avx2", "avx512"
    std::string device;                  // "" = best; else an index or part of a name, case-insensitive
    std::filesystem::path cache_folder;  // cache of BVHs and compiled kernels; "" = none
    std::chrono::nanoseconds simulated_sample_cost{
        0};                                   // null only: fixed time per sample, for scheduler benchmarks
    std::shared_ptr<scene::BlobStore> blobs;  // never null
};

// One row of the table in backends/catalog.cpp.
struct BackendEntry {
    std::string name;
    std::string summary;
    std::function<std::unique_ptr<Backend>(const BackendSettings&)>
        make;                     // throws Error when it cannot start
    bool chooses_device = false;  // whether it uses BackendSettings::device
};

}  // namespace tessera::backend
