#pragma once

#include "master/render/view_table.h"

namespace tessera::master {

// Whether the end of the view brings a picture: one is wanted, and the last pass has samples.
bool has_picture(const ViewState& view, session::PictureEncoding wanted);

session::ViewProgress progress_of(const ViewState& view, std::uint32_t nodes);

// What became of a view that has ended. `bytes`: of the master, by now.
session::ViewSummary summary_of(const ViewState& view, const SceneFacts& facts,
                                const session::WireBytes& bytes);

// Adds to a picture's summary what only the view knows: the size that it was rendered at, and why.
void describe(const ViewState& view, session::PictureSummary& picture);

}  // namespace tessera::master
