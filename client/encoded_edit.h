#pragma once

#include "mediator/net/channel.h"
#include "mediator/scene/blob.h"
#include "mediator/scene/change_list.h"

namespace tessera::client {

// An edit as it is sent, and as often as it is sent: its message, or one that names a blob which has it.
struct EncodedEdit {
    net::Bytes message;
    scene::BlobPtr content;  // not null: kept until the master has it
};

// The blob goes into `blobs`.
EncodedEdit encode_edit(scene::Edit edit, scene::BlobStore& blobs);

}  // namespace tessera::client
