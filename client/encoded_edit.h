#pragma once

#include "mediator/net/channel.h"
#include "mediator/scene/blob.h"
#include "mediator/scene/change_list.h"

namespace tessera::client {

// An encoded edit, kept for resending: its message, or a message that refers to a blob with its contents.
struct EncodedEdit {
    net::Bytes message;
    scene::BlobPtr content;  // not null: kept until the master has it
};

// The blob goes into `blobs`.
EncodedEdit encode_edit(scene::Edit edit, scene::BlobStore& blobs);

}  // namespace tessera::client
