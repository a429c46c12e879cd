#pragma once

#include "mediator/codec/codec.h"
#include "mediator/scene/change_list.h"

// Private to wire/*.cpp: entries of change lists and edits. An update carries the fields of its mask only. A decoded
// entry may still be invalid in a scene.
namespace tessera::codec {

template <>
struct CustomCodec<scene::Entry> {
    static void write(FormatWriter& out, const scene::Entry& entry);
    static void read(FormatReader& in, scene::Entry& entry);
};

}  // namespace tessera::codec
