#include "mediator/wire/entry_codec.h"

#include "mediator/scene/fields.h"

namespace tessera::codec {

namespace {

enum class Action : std::uint8_t { Create, Update, Remove };
constexpr auto enumerators(Action) {
    return std::to_array<std::string_view>({"create", "update", "remove"});
}

// Entry of proto/scene.proto without the object, whose fields depend on the mask.
struct Head {
    ObjectId id;
    Action action = Action::Create;
    scene::FieldMask mask = 0;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "id", &Head::id), row(2, "action", &Head::action),
                          row(3, "mask", &Head::mask));
    }
};
constexpr std::uint32_t ObjectTag = make_tag(4, WireType::Length);

void write_object(FormatWriter& out, const scene::Object& object, scene::FieldMask mask) {
    const std::size_t start = out.begin(ObjectTag);
    write_oneof(out, object, mask);
    out.end(start);
}

// The encoded object, located in place; the mask may follow it.
void read_object(FormatReader in, scene::Object& object, scene::FieldMask mask) {
    std::optional<std::span<const std::byte>> content;
    while (const std::uint32_t tag = in.tag()) {
        if (tag == ObjectTag) {
            content = in.block();
        } else {
            in.skip(tag);
        }
    }
    in.enter("object");
    if (!content) in.fail("an entry lacks its object");
    FormatReader object_in(*content, in);
    read_oneof(object_in, object, mask);
}

}  // namespace

void CustomCodec<scene::Entry>::write(FormatWriter& out, const scene::Entry& entry) {
    if (const auto* update = std::get_if<scene::Update>(&entry)) {
        write_rows(out, Head{update->id, Action::Update, update->mask});
        write_object(out, update->fields, update->mask);
    } else if (const auto* create = std::get_if<scene::Create>(&entry)) {
        write_rows(out, Head{create->id, Action::Create});
        write_object(out, create->object, AllRows);
    } else {
        write_rows(out, Head{scene::id(entry), Action::Remove});
    }
}

void CustomCodec<scene::Entry>::read(FormatReader& in, scene::Entry& entry) {
    const FormatReader again = in;
    Head head;
    read_rows(in, head);
    switch (head.action) {
        case Action::Create:
            read_object(again, entry.emplace<scene::Create>(scene::Create{head.id, {}}).object, AllRows);
            return;
        case Action::Update: {
            auto& update = entry.emplace<scene::Update>(scene::Update{head.id, head.mask, {}});
            read_object(again, update.fields, head.mask);
            if ((update.mask & ~scene::all_fields(update.fields)) != 0)
                in.fail("an update has unknown fields");
            return;
        }
        case Action::Remove:
            entry = scene::Remove{head.id};
            return;
    }
}

}  // namespace tessera::codec
