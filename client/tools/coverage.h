#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "mediator/frame/film_tile.h"
#include "mediator/frame/image.h"
#include "mediator/scene/change_list.h"
#include "mediator/view/view.h"

namespace tessera::tools {

// The samples of a pixel as pixels of a larger picture. A film keeps one object of each of its pixels, the
// nearest; so each gets one sample, and what is counted is exact, whoever rendered it.
struct SampleGrid {
    std::uint32_t across = 1, down = 1;
    std::uint32_t count() const { return across * down; }
};
SampleGrid sample_grid(std::uint32_t samples);                    // as square as it can be
void spread(view::View& view, SampleGrid grid);                   // size and window, of the same picture
frame::Image gather(const frame::Image& image, SampleGrid grid);  // means; of a size that the grid divides

// What is seen of an object: of how many samples it is the first thing in their way.
struct CoveredObject {
    ObjectId id;
    std::string name;  // as in the scene, may be empty
    std::uint64_t samples = 0;
};

struct Coverage {
    std::uint64_t samples = 0;           // of the picture
    std::uint64_t background = 0;        // of them, with nothing in their way
    std::vector<CoveredObject> objects;  // that are seen: most first, ties by id
    std::uint64_t unseen = 0;            // geometries that are not
};

// Of a film with ObjectIndex and one sample per pixel, and the scene that it shows.
Coverage count_coverage(const frame::FilmTile& film, const std::vector<scene::Create>& scene);

// `samples`: of each pixel of the picture, whose size is that of the view before it was spread.
std::string as_json(const Coverage& coverage, std::uint32_t samples);
std::string as_text(const Coverage& coverage, std::uint32_t samples);

}  // namespace tessera::tools
