#pragma once

#include <tbb/task_arena.h>

#include <memory>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "mediator/base/clock.h"
#include "mediator/base/in_place_list.h"
#include "mediator/filter/inputs.h"

// The interface of a denoiser: sample statistics in, one image out. It does not depend on nodes or tiles, does not
// tone-map, and gives the same bits for any number of threads.
namespace tessera::filter {

// A number, or a choice among names (then the value is the index). Every run uses the current values.
struct Parameter {
    std::string_view name, unit, meaning;
    double default_value = 0.0, minimum = 0.0, maximum = 0.0;
    std::vector<std::string_view> choices;  // empty: a number
};

// In the order of the description's parameters.
using Values = std::vector<double>;

struct Description {
    std::string_view name, summary, source;  // source: "Schwenk 3"
    double bytes_per_pixel = 0.0;            // of the memory that an instance keeps between runs, at most
    std::vector<Parameter> parameters;
    frame::ChannelSet (*channels)(const Values&);  // read by a run with these values
    // Its error goes to 0 with the number of samples. Otherwise it is biased.
    bool consistent = false;
    bool reads_variances = false;
    // Keeps a history of earlier films: reset() drops it.
    bool temporal = false;
    // Keeps results for later pictures of the same film, with some values: reset() drops them.
    bool incremental = false;
    bool needs_own_instance() const { return temporal || incremental; }  // for each view
    // The same samples give the same bits on every machine.
    bool reproducible = true;
    // The paths for HighVariance, if it reads that channel.
    view::PathClass path_class = view::PathClass::Indirect;
};
Values default_values(const Description& description);

struct DebugMap {
    std::string name;  // EXR layer: "blend"
    Planes planes;
};

struct Output {
    bool wants_maps = false;
    Planes picture;  // Inputs::color_components(); linear; finite wherever the inputs are
    std::vector<DebugMap> maps;
};

struct Pass {
    std::string_view name;
    Duration time{};
    double bytes_per_pixel = 0.0;  // read and written, each plane once per sweep over it
};
struct Report {
    InPlaceList<Pass, 64> passes;
    InPlaceList<std::string_view, 4>
        notes;             // for the user, such as a fallback that was used; string literals
    bool stopped = false;  // on request: the picture is invalid
};

struct RunContext {
    tbb::task_arena& arena;
    std::stop_token stop;
};

// For one picture size. After the first `run` it allocates nothing. One thread at a time.
class Filter {
  public:
    virtual ~Filter() = default;
    virtual Report run(const Inputs& inputs, const Values& values, Output& out, RunContext context) = 0;
    virtual void reset() {}
};

// One row of the table in master/filter/catalog.cpp.
struct FilterEntry {
    Description description;
    std::unique_ptr<Filter> (*make)(std::uint32_t width, std::uint32_t height);
    // Why it cannot run on this machine, with the remedy; "" if it can. Null: it runs on every machine.
    std::string (*why_unavailable)() = nullptr;
};

}  // namespace tessera::filter
