#include "client/encoded_edit.h"

#include "mediator/wire/envelope.h"

namespace tessera::client {

EncodedEdit encode_edit(scene::Edit edit, scene::BlobStore& blobs) {
    wire::ControlMessage message = wire::SubmitEdit{std::move(edit)};
    const scene::Edit& inside = std::get<wire::SubmitEdit>(message).edit;
    EncodedEdit encoded;
    if (wire::may_fit_control(inside.entries.size())) encoded.message = wire::encode(message);
    if (encoded.message.empty() || !wire::fits_control(encoded.message)) {
        encoded.content = blobs.insert(wire::encode(inside));
        encoded.message = wire::encode(wire::ControlMessage(wire::SubmitEditByBlob{
            inside.session, inside.sequence, inside.base, scene::reference(*encoded.content)}));
    }
    return encoded;
}

}  // namespace tessera::client
