#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "master/render/scene_state.h"
#include "mediator/filter/choice.h"
#include "mediator/frame/film_tile.h"
#include "mediator/wire/messages.h"

namespace tessera::master {

// A picture reconstructed from a film, and its summary.
struct Reconstruction {
    session::PictureSummary summary;
    std::shared_ptr<const std::vector<std::byte>> bytes;  // never null; empty when it failed
    std::string error;
};

// The inputs of a reconstruction.
struct Films {
    const frame::FilmTile& film;
    const frame::FilmTile* later = nullptr;  // of fewer samples, with channels that `film` lacks
    const frame::FilmTile* features =
        nullptr;  // of the full size, if `film` is smaller and is to be upsampled
};

// How a picture is encoded.
struct PictureFormat {
    session::PictureEncoding encoding = session::PictureEncoding::None;
    view::DisplayTransform transform;
    ViewId view;                     // all of its pictures use the exposure measured in the first
    std::vector<Rect> failed_tiles;  // to be marked in a PNG or JPEG
    Rect window;                     // of the picture, which they are relative to
};

// Filters whole films and encodes them. A filter that keeps something from one picture of a view to the next has an
// instance for every view and is given the changes between them; of the other filters, views of one size share an
// instance. Called by one thread; runs on all cores.
class Reconstructor {
  public:
    // Of view.id; `scene` is in the film.
    Reconstruction reconstruct(const Films& films, const view::View& view, const SceneState& scene,
                               const PictureFormat& format);

    // The filtered picture only, owned by this object until the next call. Throws Error.
    const filter::Planes& filtered(const frame::FilmTile& film, const view::View& view,
                                   const SceneState& scene);
    tbb::task_arena& arena() { return arena_; }

    // Seconds that a reconstruction takes for a synthetic film of this size: for the first prediction.
    double calibrate(const view::View& view, session::PictureEncoding encoding, std::uint32_t width,
                     std::uint32_t height);

    void forget(ViewId first, ViewId last);  // filters and exposures of the views [first, last)
    std::size_t filter_count() const { return instances_.size(); }

  private:
    struct InstanceKey {
        std::string name;
        std::uint32_t width = 0, height = 0;
        ViewId view;  // 0: of all views
        friend auto operator<=>(const InstanceKey&, const InstanceKey&) = default;
    };
    struct Instance {
        std::unique_ptr<filter::Filter> filter;
        std::size_t users = 0;
    };
    // The filter of a view, and the film it last processed.
    struct User {
        InstanceKey key;
        std::uint64_t revision = 0;
        Version version;
    };
    // Ready for the picture; sets in `inputs` what has changed since the previous one.
    filter::Filter& instance(const filter::Choice& choice, const view::View& view, const SceneState& scene,
                             filter::Inputs& inputs);
    void release(const InstanceKey& key);
    std::vector<std::byte> encode(const filter::Planes& picture, const PictureFormat& format,
                                  session::PictureSummary& summary);

    tbb::task_arena arena_;
    std::map<InstanceKey, Instance> instances_;
    std::map<ViewId, User> users_;
    std::map<ViewId, double> exposures_;   // EV, measured
    filter::Inputs inputs_, full_inputs_;  // kept for their memory
    filter::Output output_;
    filter::Planes upsampled_;
};

}  // namespace tessera::master
