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

// What a reconstruction owes the picture: statistics of samples in, one image out. It knows neither nodes nor
// tiles, does not tone-map, and gives the same bits for any number of threads.
namespace tessera::filter {

// A number, or a choice among names (then the value is the index). All are live: a run reads them anew.
struct Parameter {
    std::string_view name, unit, meaning;
    double standard = 0.0, least = 0.0, most = 0.0;  // the default, and the range that is accepted
    std::vector<std::string_view> choices;           // empty: a number
};

// In the order of the description's parameters.
using Values = std::vector<double>;

struct Description {
    std::string_view name, summary, source;  // source: "Schwenk 3"
    std::vector<Parameter> parameters;
    frame::ChannelSet (*channels)(const Values&);  // that a run with these values reads
    // Its error goes to 0 with the samples, and it does not worsen a converged picture. Otherwise it is
    // biased.
    bool consistent = false;
    // Keeps a history between runs: reset() drops it.
    bool temporal = false;
    // What paths go to HighVariance, where it matters which.
    view::PathClass path_class = view::PathClass::Indirect;
};
Values standard_values(const Description& description);

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
        notes;             // what a user should know, as a fallback that was taken; literals
    bool stopped = false;  // asked to: the picture means nothing
};

struct RunContext {
    tbb::task_arena& arena;
    std::stop_token stop;
};

// Made for one size. `run` allocates nothing once it has seen its inputs; one thread at a time.
class Filter {
  public:
    virtual ~Filter() = default;
    virtual Report run(const Inputs& inputs, const Values& values, Output& out, RunContext context) = 0;
    virtual void reset() {}
};

// One line of the explicit table in master/filter/catalog.cpp.
struct FilterEntry {
    Description description;
    std::unique_ptr<Filter> (*make)(std::uint32_t width, std::uint32_t height);
};

}  // namespace tessera::filter
