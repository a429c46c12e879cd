#pragma once

#include "mediator/scene/change_list.h"
#include "proto/scene.pb.h"

// Private to wire/*.cpp. read() throws Error{InvalidInput}; what is decoded may still be invalid as a scene.
namespace tessera::wire {

void write(const scene::ChangeList& changes, proto::ChangeList& to);
void read(proto::ChangeList& from, scene::ChangeList& changes);
void write(const scene::Entry& entry, proto::Entry& to);
scene::Entry read(proto::Entry& from);
void write(const scene::Edit& edit, proto::Edit& to);
void read(proto::Edit& from, scene::Edit& edit);

}  // namespace tessera::wire
