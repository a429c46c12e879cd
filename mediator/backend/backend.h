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

// What a renderer owes the cluster: scene in by change lists, statistics of samples out. It knows no network,
// no other node, no window and no file. A sample is a pure function of (scene content, view, pixel, sample
// index).
namespace tessera::backend {

struct Capabilities {
    frame::ChannelSet channels;
    view::RendererSet renderers = view::TracingRenderers;
    std::uint32_t preferred_tile = 32;   // pixels, edge of a square
    std::uint32_t concurrent_units = 1;  // render() calls worth running at a time
    bool deterministic = true;
    std::string
        kind;  // back-end, build, instruction set or device, render revision: equal kinds give equal bits
};

struct EditReport {
    std::uint32_t entries = 0, relevant = 0;
    std::uint32_t rebuilt = 0;        // geometries whose acceleration structure was built anew, not read back
    std::uint32_t refitted = 0;       // geometries refitted in place
    std::uint32_t retransformed = 0;  // instances that only moved
    std::uint64_t triangles = 0, instances = 0, lights = 0;  // of the scene after the edit
    std::uint64_t degenerate_triangles = 0;                  // counted and skipped
    std::uint64_t uploaded_bytes = 0;        // by this edit, to a device with memory of its own
    std::vector<std::string> ignored_kinds;  // object kinds this back-end does not draw
    // Objects drawn as placeholders, and why, each once per content; what the cache folder had that is no
    // good.
    std::vector<std::string> problems;
};

// Lives between begin_edit() and its own end; no render runs meanwhile. Destroying it without commit() leaves
// the last good version.
class EditScope {
  public:
    virtual ~EditScope() = default;
    // Any number of consecutive lists, each with the scene that it makes, of which the back-end keeps a copy (they
    // share their objects). All blobs they refer to are in the store. InvalidInput: wrong `from`.
    virtual Expected<void> apply(const scene::ChangeList& changes, const scene::Scene& after) = 0;
    // The same for owners that keep no scene themselves. InvalidInput: what Scene::apply refuses, too.
    Expected<void> apply(const scene::ChangeList& changes);
    virtual const scene::Scene& scene() const = 0;  // after the lists so far
    // Brings device structures in step at the cheapest level that can hold each change; once. OutOfMemory:
    // the device has no room for it, and the last good version stays.
    virtual Expected<EditReport> commit() = 0;
};

enum class RenderStatus {
    Done,     // one block: the unit's
    Stopped,  // the complete prefix as its maximal aligned blocks, possibly none
    Refused,  // the unit names another version
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

    // Thread-safe: several units at a time. Finishes a sample over the whole tile before the next, so a stop
    // leaves whole aligned blocks; returns within 50 ms of the stop. Never throws for content; Error for
    // device failures, and for a renderer that is not among its capabilities.
    virtual RenderResult render(const view::View& view, const view::WorkUnit& unit, std::stop_token stop) = 0;

    // Replays one sample and tells each vertex of its path, one line each; the picture is not touched.
    virtual std::vector<std::string> probe(const view::View& view, std::uint32_t x, std::uint32_t y,
                                           std::uint64_t sample) = 0;
};

// Throws Error{Refused}, naming the remedy, for a view that asks for a renderer that is not among these.
void require_renderer(view::RendererSet offered, const view::View& view);

struct BackendSettings {
    std::uint32_t threads = 0;           // 0 = all cores
    std::string isa;                     // "" = best, "avx2", "avx512"
    std::string device;                  // "" = best; else an index or a part of a name, letter case aside
    std::filesystem::path cache_folder;  // for what can be made again (trees, compiled kernels); "" = none
    std::chrono::nanoseconds simulated_sample_cost{
        0};                                   // null only: fixed time per sample, for scheduler benchmarks
    std::shared_ptr<scene::BlobStore> blobs;  // never null
};

// One line of the explicit table in backends/catalog.cpp.
struct BackendEntry {
    std::string name;
    std::string summary;
    std::function<std::unique_ptr<Backend>(const BackendSettings&)>
        make;                     // throws Error when it cannot start
    bool chooses_device = false;  // whether BackendSettings::device means anything to it
};

}  // namespace tessera::backend
