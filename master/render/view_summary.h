#pragma once

#include "master/render/view_table.h"

namespace tessera::master {

// Whether the end of the view brings a picture: one is wanted, and the last pass has samples.
bool has_picture(const ViewState& view, wire::PictureEncoding wanted);

wire::JobProgress progress_of(const ViewState& view, JobId job, std::uint32_t nodes);

// What became of a view that has ended. `bytes`: of the master, by now.
wire::JobDone summary_of(const ViewState& view, const SceneFacts& facts, const wire::WireBytes& bytes);

// Adds to a picture's summary what only the view knows: the size that it was rendered at, and why.
void describe(const ViewState& view, wire::PictureSummary& picture);

}  // namespace tessera::master
