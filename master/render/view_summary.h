#pragma once

#include "master/render/view_table.h"
#include "mediator/net/channel.h"
#include "mediator/wire/view_messages.h"

namespace tessera::master {

// Whether the end of the view brings a picture: one is wanted, and the last pass has samples.
bool has_picture(const ViewState& view, session::PictureEncoding wanted);

session::ViewProgress progress_of(const ViewState& view, std::uint32_t nodes);

// What became of a view that has ended. `bytes`: of the master, by now.
session::ViewSummary summary_of(const ViewState& view, const SceneFacts& facts,
                                const session::WireBytes& bytes);

// As a message that fits the control link: of very many nodes those with the fewest samples are left out, and a note
// says how many.
net::Bytes encoded(wire::ViewDone done);

// Adds to a picture's summary what only the view knows: the size that it was rendered at, and why.
void describe(const ViewState& view, session::PictureSummary& picture);

}  // namespace tessera::master
