#include "mediator/frame/tile_film.h"
#include "mediator/scene/scene.h"
#include "mediator/scene/validate.h"
#include "mediator/wire/display_codec.h"
#include "mediator/wire/envelope.h"
#include "mediator/wire/film_state_codec.h"
#include "tests/fuzz/decoders/decoder.h"
#include "tests/fuzz/decoders/round_trip.h"
#include "tests/wire/sample_messages.h"

// What peers send.
namespace tessera::fuzz {

namespace {

void control(Bytes bytes) {
    const auto message = wire::decode_control(bytes);
    if (!message) return require_reason(message.error());
    // Numbers that a sender left out are written, so that a message can become too long.
    if (wire::fits_control(wire::encode(*message))) require_round_trip(*message, wire::decode_control);
}

Seeds control_seeds() {
    Seeds seeds;
    for (const wire::ControlMessage& message : wire::control_messages())
        seeds.push_back(wire::encode(message));
    return seeds;
}

void bulk(Bytes bytes) {
    const auto head = wire::film_head(bytes);
    const auto message = wire::decode_bulk(bytes);
    if (!message) return require_reason(message.error());
    require(wire::is_bulk(bytes), "a bulk message was decoded from other bytes");
    const auto* film = std::get_if<wire::FilmPart>(&*message);
    require(wire::is_film(bytes) == (film != nullptr), "film is not known by its header");
    require(head.has_value() == (film != nullptr), "the head of film is another message's");
    if (film != nullptr) {
        require(head->unit == film->unit && head->rect == film->film.rect && head->block == film->film.block,
                "the head of film differs from the film");
    }
    require_round_trip(*message, wire::decode_bulk);
}

Seeds bulk_seeds() {
    Seeds seeds;
    for (const wire::BulkMessage& message : wire::bulk_messages()) seeds.push_back(wire::encode(message));
    return seeds;
}

// A scene that takes the changes is the same after it was sent to another peer.
void change_list(Bytes bytes) {
    const auto changes = wire::decode_change_list(bytes);
    if (!changes) return require_reason(changes.error());
    require_round_trip(*changes, wire::decode_change_list);
    scene::Scene scene;
    if (const auto applied = scene.apply_entries(changes->entries); !applied)
        return require_reason(applied.error());
    (void)scene::validate(scene);
    (void)scene::referenced_blobs(scene);
    const auto sent = wire::decode_change_list(wire::encode(scene::snapshot(scene)));
    require(sent.has_value(), "the snapshot of a scene cannot be decoded");
    scene::Scene other;
    require(other.apply(*sent).has_value(), "the snapshot of a scene cannot be applied");
    require(other.state_hash() == scene.state_hash(), "a sent scene has another hash");
}

scene::ChangeList some_scene() {
    scene::ChangeList changes = wire::some_changes();
    std::erase_if(changes.entries,
                  [](const scene::Entry& entry) { return !std::holds_alternative<scene::Create>(entry); });
    changes.entries.emplace_back(scene::Create{scene::RootId, scene::Root{.children = {ObjectId{7}}}});
    return changes;
}

Seeds change_list_seeds() {
    return {wire::encode(wire::some_changes()), wire::encode(some_scene())};
}

void edit(Bytes bytes) {
    const wire::EditSize size = wire::measure_edit(bytes);
    const auto edit = wire::decode_edit(bytes);
    if (!edit) return require_reason(edit.error());
    require(edit->entries.size() == size.entries, "an edit has more entries than were measured");
    require_round_trip(*edit, wire::decode_edit);
}

Seeds edit_seeds() {
    return {wire::encode(scene::Edit{SessionId{1}, 2, {3, 4}, wire::some_changes().entries}),
            wire::encode(scene::Edit{.entries = some_scene().entries})};
}

void display_blob(Bytes bytes) {
    const auto display = wire::decode_display(bytes);
    if (!display) return require_reason(display.error());
    require_round_trip(*display, wire::decode_display);
}

Seeds display_blob_seeds() {
    display::Output output{.name = "left", .width = 1440, .height = 1050, .turn = display::Turn::Quarter};
    output.points = {2, 1, 3, display::Grid::Nodes::Centres, {blake2b({}), 24}};
    output.blend = {.left = 10, .shape = 2.0, .weights = output.points, .lift = output.points};
    output.color.curve = {0.0f, 0.3f, 1.0f};
    display::Display display{.name = "wall", .camera = "main", .units_per_metre = 100.0};
    display.layers = {{"model", view::Renderer::PathTracing, 1, true}};
    display.outputs = {output, {.name = "right"}};
    return {wire::encode(display)};
}

void film_state(Bytes bytes) {
    const auto film = wire::decode_film_state(bytes);
    if (!film) return require_reason(film.error());
    require_round_trip(*film, wire::decode_film_state);
    const Rect tile = film->blocks.empty() ? Rect{} : film->blocks.front().rect;
    frame::TileFilm merged;
    for (const frame::FilmTile& block : film->blocks) {
        if (block.rect == tile && block.channels == film->blocks.front().channels) (void)merged.insert(block);
    }
    if (!merged.empty()) (void)merged.merged();
}

Seeds film_state_seeds() {
    const Rect tile{8, 0, 8, 4};
    frame::FilmTile block(tile, {0, 4}, {frame::Channel::Radiance});
    std::fill(block.counts.begin(), block.counts.end(), 16u);
    frame::FilmTile more(tile, {16, 4}, block.channels, frame::PixelSet({1, 5}, 32));
    std::fill(more.counts.begin(), more.counts.end(), 16u);
    return {wire::encode(frame::FilmState{
                .blocks = {block, more}, .steps = 1, .wanted = {{tile, {16, 4}, frame::PixelSet({0}, 32)}}}),
            wire::encode(frame::FilmState{.blocks = {block}, .wanted = {}})};
}

}  // namespace

std::vector<Decoder> message_decoders() {
    return {{"control", control, control_seeds},
            {"bulk", bulk, bulk_seeds},
            {"change-list", change_list, change_list_seeds},
            {"edit", edit, edit_seeds},
            {"film-state", film_state, film_state_seeds},
            {"display-blob", display_blob, display_blob_seeds}};
}

}  // namespace tessera::fuzz
