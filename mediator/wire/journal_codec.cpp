#include "mediator/wire/journal_codec.h"

#include <limits>
#include <utility>

#include "mediator/scene/fields.h"
#include "mediator/wire/envelope.h"
#include "mediator/wire/journal_mapping.h"

namespace tessera::wire {

namespace {

proto::JournalEditor& part(proto::JournalRecord& record, const RecordedEditor&) {
    return *record.mutable_joined();
}
proto::JournalEdit& part(proto::JournalRecord& record, const RecordedEdit&) {
    return *record.mutable_edit();
}
proto::JournalTitle& part(proto::JournalRecord& record, const RecordedTitle&) {
    return *record.mutable_title();
}
proto::JournalClosed& part(proto::JournalRecord& record, const RecordedClose&) {
    return *record.mutable_closed();
}

template <class P>
std::vector<std::byte> serialised(const P& message) {
    std::vector<std::byte> bytes(message.ByteSizeLong());
    if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
        throw Error(ErrorCode::OutOfMemory, "the scene's state is longer than 2 GiB: it cannot be kept");
    message.SerializeToArray(bytes.data(), static_cast<int>(bytes.size()));
    return bytes;
}

template <class P>
void parse(std::span<const std::byte> bytes, P& message) {
    if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()) ||
        !message.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) {
        malformed("it is no protobuf message of its kind");
    }
}

void check_writers(const std::vector<RecordedFieldWriter>& fields, std::size_t writers) {
    for (const RecordedFieldWriter& entry : fields) {
        if (entry.field >= 32 || entry.writer > writers) malformed("a field's writer is unknown");
    }
}

// What the restored authority relies on without looking again.
void check(const CheckpointState& state) {
    if (!state.scene.is_snapshot()) malformed("its scene is no snapshot");
    for (const RecordedObjectWriters& entry : state.objects)
        check_writers(entry.fields, state.writers.size());
    std::uint64_t last = 0;
    for (const RecordedTransaction& transaction : state.transactions) {
        if (transaction.number <= last || transaction.number > state.last_transaction)
            malformed("its transactions are not in order");
        last = transaction.number;
        if (transaction.author == 0 || transaction.author > state.writers.size())
            malformed("a transaction has no author");
        if (transaction.undoes >= transaction.number) malformed("a transaction undoes a younger one");
        for (const RecordedChange& change : transaction.changes) {
            if (!change.before && !change.after) malformed("a change has no object");
            const scene::Object& object = change.after ? *change.after : *change.before;
            if ((change.mask & ~scene::all_fields(object)) != 0) malformed("a change has unknown fields");
            check_writers(change.writers_before, state.writers.size());
            check_writers(change.writers_after, state.writers.size());
        }
    }
}

}  // namespace

std::vector<std::byte> encode(const JournalRecord& record) {
    proto::JournalRecord message;
    std::visit([&](const auto& value) { map(Writer(), value, part(message, value)); }, record);
    return serialised(message);
}

Expected<JournalRecord> decode_journal_record(std::span<const std::byte> bytes) {
    try {
        proto::JournalRecord message;
        parse(bytes, message);
        const auto get = [&](auto value) {
            map(Reader(), value, part(message, value));
            return JournalRecord(std::move(value));
        };
        switch (message.kind_case()) {
            case proto::JournalRecord::kJoined:
                return get(RecordedEditor{});
            case proto::JournalRecord::kEdit:
                return get(RecordedEdit{});
            case proto::JournalRecord::kTitle:
                return get(RecordedTitle{});
            case proto::JournalRecord::kClosed:
                return get(RecordedClose{});
            default:
                malformed("a record of an unknown kind");
        }
    } catch (const Error& error) {
        return tl::unexpected(error);
    }
}

std::vector<std::byte> encode(const CheckpointState& state) {
    proto::Checkpoint message;
    const Writer io;
    message.set_journal(state.journal);
    message.set_title(state.title);
    write(state.scene, *message.mutable_scene());
    message.set_last_transaction(state.last_transaction);
    io.messages(state.writers, message.mutable_writers(), MaxRecorded);
    io.messages(state.objects, message.mutable_objects(), MaxRecorded);
    io.messages(state.transactions, message.mutable_transactions(), MaxRecorded);
    io.messages(state.editors, message.mutable_editors(), MaxRecorded);
    for (const SavedView& view : state.views) {
        proto::JournalView& to = *message.add_views();
        map(io, view, to);
        to.set_blocks(view.blocks.size());
    }
    message.set_render_revision(state.render_revision);
    return serialised(message);
}

Expected<CheckpointState> decode_checkpoint(std::span<const std::byte> bytes) {
    try {
        proto::Checkpoint message;
        parse(bytes, message);
        const Reader io;
        CheckpointState state;
        state.journal = message.journal();
        state.title = message.title();
        read(*message.mutable_scene(), state.scene);
        state.last_transaction = message.last_transaction();
        io.messages(state.writers, message.mutable_writers(), MaxRecorded);
        io.messages(state.objects, message.mutable_objects(), MaxRecorded);
        io.messages(state.transactions, message.mutable_transactions(), MaxRecorded);
        io.messages(state.editors, message.mutable_editors(), MaxRecorded);
        io.messages(state.views, message.mutable_views(), MaxRecorded);
        for (const proto::JournalView& view : message.views()) state.block_counts.push_back(view.blocks());
        state.render_revision = message.render_revision();
        check(state);
        return state;
    } catch (const Error& error) {
        return tl::unexpected(error);
    }
}

std::vector<std::byte> encode_film(const frame::FilmTile& film) {
    return encode(BulkMessage(FrameTile{.job = {}, .index = 0, .count = 1, .film = film}));
}

Expected<frame::FilmTile> decode_film(std::span<const std::byte> bytes) {
    auto message = decode_bulk(bytes);
    if (!message) return tl::unexpected(message.error());
    auto* tile = std::get_if<FrameTile>(&*message);
    if (tile == nullptr) return failure(ErrorCode::InvalidInput, "malformed message: not a block of film");
    return std::move(tile->film);
}

}  // namespace tessera::wire
