#pragma once

#include "master/render/view_table.h"
#include "mediator/net/channel.h"
#include "mediator/wire/view_messages.h"

namespace tessera::master {

// A rectangle of the pass in pixels of the whole picture.
Rect in_full_size(const ViewState& view, const Pass& pass, const Rect& rect);
// "2 tiles could not be rendered by any node: ...", with the command that replays the first.
std::string failed_tiles_text(const ViewState& view);

// Whether the view ends with a picture: one is wanted, and the last pass has samples.
bool has_picture(const ViewState& view, session::PictureEncoding wanted);

session::ViewProgress progress_of(const ViewState& view, std::uint32_t nodes);

// Of a view that has ended. `bytes`: the master's current counters.
session::ViewSummary summary_of(const ViewState& view, const SceneFacts& facts,
                                const session::WireBytes& bytes);

// As a message that fits the control link: if there are too many nodes, those with the fewest samples are omitted, and
// a note says how many.
net::Bytes encoded(wire::ViewDone done);

// Adds the view's facts to a picture's summary: the size that it was rendered at, and why.
void describe(const ViewState& view, session::PictureSummary& picture);

}  // namespace tessera::master
