#include "mediator/wire/journal_codec.h"

#include <utility>

#include "mediator/scene/fields.h"
#include "mediator/wire/entry_codec.h"
#include "mediator/wire/envelope.h"

namespace tessera::wire {

using namespace codec;

namespace {

bool known(const std::vector<RecordedFieldWriter>& fields, std::size_t writers) {
    return std::ranges::all_of(fields, [&](const RecordedFieldWriter& entry) {
        return entry.field < scene::MaxFields && entry.writer <= writers;
    });
}

const char* contradiction(const RecordedChange& change, std::size_t writers) {
    if (!change.before && !change.after) return "a change has no object";
    const scene::Object& object = change.after ? *change.after : *change.before;
    if ((change.mask & ~scene::all_fields(object)) != 0) return "a change has unknown fields";
    if (!known(change.writers_before, writers) || !known(change.writers_after, writers))
        return "a field's writer is unknown";
    return nullptr;
}

// Checks everything that the restored authority relies on: null, or the error.
const char* contradiction(const CheckpointState& state) {
    const std::size_t writers = state.writers.size();
    if (!state.scene.is_snapshot()) return "its scene is no snapshot";
    for (const RecordedObjectWriters& entry : state.objects) {
        if (!known(entry.fields, writers)) return "a field's writer is unknown";
    }
    std::uint64_t last = 0;
    for (const RecordedTransaction& transaction : state.transactions) {
        if (transaction.number <= last || transaction.number > state.last_transaction)
            return "its transactions are not in order";
        last = transaction.number;
        if (transaction.author == 0 || transaction.author > writers) return "a transaction has no author";
        if (transaction.undoes >= transaction.number) return "a transaction undoes a younger one";
        for (const RecordedChange& change : transaction.changes) {
            if (const char* problem = contradiction(change, writers)) return problem;
        }
    }
    return nullptr;
}

}  // namespace

std::optional<scene::Entry> RecordedChange::entry(const std::optional<scene::Object>& state) const {
    constexpr scene::FieldMask Name = 1;
    if (!state) return std::nullopt;
    if (before && after && before->index() == after->index())
        return scene::Update{object, mask | Name, *state};
    return scene::Create{object, *state};
}

std::optional<scene::Object> RecordedChange::state(std::optional<scene::Entry>&& entry) {
    if (auto* created = std::get_if<scene::Create>(&*entry)) return std::move(created->object);
    if (auto* updated = std::get_if<scene::Update>(&*entry)) return std::move(updated->fields);
    return std::nullopt;
}

std::vector<std::byte> encode(const JournalRecord& record) {
    return to_bytes(record);
}

Expected<JournalRecord> decode_journal_record(std::span<const std::byte> bytes) {
    return from_bytes<JournalRecord>(bytes);
}

std::vector<std::byte> encode(const StoredJob& job) {
    return to_bytes(job);
}

Expected<StoredJob> decode_stored_job(std::span<const std::byte> bytes) {
    return from_bytes<StoredJob>(bytes);
}

std::vector<std::byte> encode(const CheckpointState& state) {
    return to_bytes(state);
}

Expected<CheckpointState> decode_checkpoint(std::span<const std::byte> bytes) {
    return from_bytes<CheckpointState>(bytes).and_then(
        [](CheckpointState&& state) -> Expected<CheckpointState> {
            if (const char* problem = contradiction(state))
                return failure(ErrorCode::InvalidInput, std::string("malformed message: ") + problem);
            return std::move(state);
        });
}

std::vector<std::byte> encode_film(const frame::FilmTile& film) {
    return encode(BulkMessage(FrameTile{.frame = 0, .index = 0, .count = 1, .film = film}));
}

Expected<frame::FilmTile> decode_film(std::span<const std::byte> bytes) {
    auto message = decode_bulk(bytes);
    if (!message) return tl::unexpected(message.error());
    auto* tile = std::get_if<FrameTile>(&*message);
    if (tile == nullptr) return failure(ErrorCode::InvalidInput, "malformed message: not a block of film");
    return std::move(tile->film);
}

}  // namespace tessera::wire
