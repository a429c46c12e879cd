#pragma once

#include <string>
#include <vector>

#include "client/session.h"
#include "client/tools/view_options.h"
#include "mediator/picture/film_exr.h"

namespace tessera::tools {

// A saved film that a picture goes on with.
struct ContinuedFilm {
    std::string path;
    client::EarlierFilm film;
    view::View view;  // as it was, without filter
    std::uint32_t tile = 0;
    std::uint64_t least_samples = 0, most_samples = 0;  // per pixel
    std::string kinds;                                  // of the nodes that rendered it
};

// What such a film needs in its file, with the view it is of.
void add_continuation(picture::FilmFile& file, const view::View& view, const session::ViewSummary& summary,
                      frame::FilmState state);

// Throws Error{NotFound}, or Error{InvalidInput} if it has no film that can go on.
ContinuedFilm read_continued_film(const std::string& path);

// Of an attribute with several.
std::vector<std::string> listed_kinds(const std::string& kinds);

// The option that asks for another view than the film has; "" = none. Options that were left out agree with any.
std::string contradicting_option(const ViewOptions& given, const ViewPlan& plan, const view::View& film);

}  // namespace tessera::tools
