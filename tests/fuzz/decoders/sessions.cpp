#include <array>

#include "master/scene/checkpoint_file.h"
#include "master/scene/journal_file.h"
#include "mediator/base/hash.h"
#include "mediator/wire/journal_codec.h"
#include "tests/fuzz/decoders/decoder.h"
#include "tests/fuzz/decoders/round_trip.h"
#include "tests/wire/sample_messages.h"

// What a session folder holds. Checksums are made right, since no mutation would get past them.
namespace tessera::fuzz {

namespace {

constexpr std::uint64_t Number = 1;  // of the file

void journal_record(Bytes bytes) {
    const auto record = wire::decode_journal_record(bytes);
    if (!record) return require_reason(record.error());
    require_round_trip(*record, wire::decode_journal_record);
}

std::vector<wire::JournalRecord> some_records() {
    wire::SavedView view{.name = "main", .owner_user = "ann", .owner_key = 7, .kind = "null"};
    view.request.view = wire::some_view();
    return {wire::RecordedEditor{.number = 1, .user = "ann", .key = 9, .first_id = 2, .id_count = 100},
            wire::RecordedEdit{.editor = 1,
                               .sequence = 2,
                               .name = "ann",
                               .time = -5,
                               .entries = wire::some_changes().entries,
                               .transaction = 3,
                               .text = "add"},
            wire::RecordedTitle{"room", wire::RecordedOwner{"ann", 7}},
            wire::RecordedClose{},
            wire::RecordedJob{view},
            wire::RecordedJobEnd{{"ann", "night"}}};
}

Seeds journal_record_seeds() {
    Seeds seeds;
    for (const wire::JournalRecord& record : some_records()) seeds.push_back(wire::encode(record));
    return seeds;
}

// The whole file: records with their lengths and checksums.
void journal_file(Bytes bytes) {
    std::uint64_t records = 0;
    const master::JournalScan scan = master::read_journal(
        file_of("journal", bytes), Number, [&](std::span<const std::byte> payload) -> Expected<void> {
            ++records;
            if (const auto record = wire::decode_journal_record(payload); !record)
                return tl::unexpected(record.error());
            return {};
        });
    require(scan.byte_size == bytes.size(), "a journal has another size than its file");
    require(scan.offset <= scan.byte_size && scan.records <= records, "a journal has too many records");
    require((scan.end == master::JournalEnd::Complete) == scan.text.empty(),
            "a journal ends without a reason");
}

Seeds journal_file_seeds() {
    const std::filesystem::path path = file_of("new-journal", {});
    std::filesystem::remove(path);
    master::JournalFile file(path, Number);
    for (const wire::JournalRecord& record : some_records())
        require(file.append(wire::encode(record)).has_value(), "a record cannot be written");
    return {content_of(path)};
}

void checkpoint_state(Bytes bytes) {
    const auto state = wire::decode_checkpoint(bytes);
    if (!state) return require_reason(state.error());
    require_round_trip(*state, wire::decode_checkpoint);
}

wire::CheckpointState some_checkpoint() {
    wire::CheckpointState state{.journal = Number, .title = "room"};
    state.scene = {.to = {5, 1}, .entries = {scene::Create{scene::RootId, scene::Root{}}}};
    state.last_transaction = 2;
    state.writers = {{1, "ann", "ann", -5}};
    state.objects = {{scene::RootId, {{1, 1}}}};
    wire::RecordedChange change{.object = ObjectId{8}, .mask = 3};
    change.before = scene::Transform{.name = "before"};
    change.after = scene::Transform{.name = "after"};
    change.writers_after = {{1, 1}};
    state.transactions = {{.number = 1, .author = 1, .text = "add", .changes = {change}}};
    state.editors = {{.number = 1, .user = "ann"}};
    wire::SavedView view{.name = "main", .owner_user = "ann"};
    view.request.view = wire::some_view();
    frame::FilmTile film({0, 32, 3, 2}, {4, 2}, {frame::Channel::Radiance, frame::Channel::ObjectIndex});
    std::fill(film.counts.begin(), film.counts.end(), 4u);
    view.blocks = {film, film};
    state.views = {view};
    state.owner = wire::RecordedOwner{"ann", 7};
    return state;
}

Seeds checkpoint_state_seeds() {
    return {wire::encode(some_checkpoint())};
}

// The file without its checksum, which is added.
void checkpoint(Bytes bytes) {
    std::vector<std::byte> file(bytes.begin(), bytes.end());
    const Hash256 hash = blake2b(bytes);
    const auto checksum = std::as_bytes(std::span(hash.bytes));
    file.insert(file.end(), checksum.begin(), checksum.end());
    const auto state = master::read_checkpoint(file_of("checkpoint", file), Number);
    if (!state) return require_reason(state.error());
    for (const wire::SavedView& view : state->views)
        require(view.block_count == 0, "a checkpoint has fewer blocks of film than it says");
}

Seeds checkpoint_seeds() {
    const std::filesystem::path path = file_of("new-checkpoint", {});
    master::write_checkpoint(path, Number, some_checkpoint());
    std::vector<std::byte> file = content_of(path);
    file.resize(file.size() - sizeof(Hash256::bytes));
    return {file};
}

void job(Bytes bytes) {
    const auto job = wire::decode_stored_job(bytes);
    if (!job) return require_reason(job.error());
    require_round_trip(*job, wire::decode_stored_job);
}

Seeds job_seeds() {
    wire::StoredJob job{.width = 3, .height = 2, .components = 4};
    job.status.job = {"ann", "night"};
    job.status.scene = "room";
    job.status.has_ended = true;
    job.status.summary.picture.filter = "gauss:sigma=3";
    return {wire::encode(job)};
}

}  // namespace

std::vector<Decoder> session_decoders() {
    return {{"journal-record", journal_record, journal_record_seeds},
            {"journal", journal_file, journal_file_seeds},
            {"checkpoint-state", checkpoint_state, checkpoint_state_seeds},
            {"checkpoint", checkpoint, checkpoint_seeds},
            {"job", job, job_seeds}};
}

}  // namespace tessera::fuzz
