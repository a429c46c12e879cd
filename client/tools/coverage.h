#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "mediator/frame/film_tile.h"
#include "mediator/frame/image.h"
#include "mediator/scene/change_list.h"
#include "mediator/view/view.h"

namespace tessera::tools {

// The samples of a pixel as pixels of a larger picture. A film stores only the nearest object of each pixel; with one
// sample per pixel the counts are exact, independent of the node that rendered it.
struct SampleGrid {
    std::uint32_t across = 1, down = 1;
    std::uint32_t count() const { return across * down; }
};
SampleGrid sample_grid(std::uint32_t samples);                    // as square as possible
void spread(view::View& view, SampleGrid grid);                   // enlarges size and window
frame::Image gather(const frame::Image& image, SampleGrid grid);  // box-filters back to the original size

// The visible samples of an object: those with it as first hit.
struct CoveredObject {
    ObjectId id;
    std::string name;  // as in the scene, may be empty
    std::uint64_t samples = 0;
};

struct Coverage {
    std::uint64_t samples = 0;           // of the picture
    std::uint64_t background = 0;        // samples without a hit
    std::vector<CoveredObject> objects;  // visible ones: most samples first, ties by id
    std::uint64_t unseen = 0;            // number of invisible geometries
};

// From a film with ObjectIndex and one sample per pixel, and its scene.
Coverage count_coverage(const frame::FilmTile& film, const std::vector<scene::Create>& scene);

// `samples`: per pixel of the picture at the view's original size.
std::string as_json(const Coverage& coverage, std::uint32_t samples);
std::string as_text(const Coverage& coverage, std::uint32_t samples);

}  // namespace tessera::tools
