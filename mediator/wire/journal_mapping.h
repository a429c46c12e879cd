#pragma once

#include "mediator/wire/common_mapping.h"
#include "mediator/wire/journal_records.h"
#include "mediator/wire/scene_codec.h"
#include "mediator/wire/work_mapping.h"
#include "proto/journal.pb.h"

// Private to wire/journal_codec.cpp.
namespace tessera::wire {

inline constexpr std::size_t MaxRecorded = 16'000'000;

template <class Io>
void map(const Io& io, typename Io::template Ref<RecordedEditor> s, proto::JournalEditor& p) {
    using P = proto::JournalEditor;
    io(s.number, p, &P::number, &P::set_number);
    io.text(s.user, p.mutable_user());
    io(s.key, p, &P::key, &P::set_key);
    io(s.first_id, p, &P::first_id, &P::set_first_id);
    io(s.id_count, p, &P::id_count, &P::set_id_count);
    io(s.last_sequence, p, &P::last_sequence, &P::set_last_sequence);
    io(s.accepted, p, &P::accepted, &P::set_accepted);
    io.texts(s.problems, p.mutable_problems(), MaxRecorded);
    io(s.transaction, p, &P::transaction, &P::set_transaction);
    io.texts(s.notes, p.mutable_notes(), MaxRecorded);
    io(s.gesture, p, &P::gesture, &P::set_gesture);
    io(s.gesture_transaction, p, &P::gesture_transaction, &P::set_gesture_transaction);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<RecordedEdit> s, proto::JournalEdit& p) {
    using P = proto::JournalEdit;
    io(s.editor, p, &P::editor, &P::set_editor);
    io(s.sequence, p, &P::sequence, &P::set_sequence);
    io(s.gesture, p, &P::gesture, &P::set_gesture);
    io(s.undo, p, &P::undo, &P::set_undo);
    io.text(s.name, p.mutable_name());
    io.text(s.user, p.mutable_user());
    io(s.time, p, &P::time, &P::set_time);
    if constexpr (std::is_same_v<Io, Writer>) {
        for (const scene::Entry& entry : s.entries) write(entry, *p.add_entries());
    } else {
        s.entries.clear();
        for (proto::Entry& entry : *p.mutable_entries()) s.entries.push_back(read(entry));
    }
    io(s.transaction, p, &P::transaction, &P::set_transaction);
    io.message(s.state_hash, p.mutable_state_hash());
    io.text(s.text, p.mutable_text());
}

template <class Io>
void map(const Io& io, typename Io::template Ref<RecordedTitle> s, proto::JournalTitle& p) {
    io.text(s.title, p.mutable_title());
}

template <class Io>
void map(const Io&, typename Io::template Ref<RecordedClose>, proto::JournalClosed&) {}

template <class Io>
void map(const Io& io, typename Io::template Ref<RecordedWriter> s, proto::JournalWriter& p) {
    using P = proto::JournalWriter;
    io(s.transaction, p, &P::transaction, &P::set_transaction);
    io.text(s.name, p.mutable_name());
    io.text(s.user, p.mutable_user());
    io(s.time, p, &P::time, &P::set_time);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<RecordedFieldWriter> s, proto::JournalFieldWriter& p) {
    using P = proto::JournalFieldWriter;
    io(s.field, p, &P::field, &P::set_field);
    io(s.writer, p, &P::writer, &P::set_writer);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<RecordedObjectWriters> s, proto::JournalObjectWriters& p) {
    using P = proto::JournalObjectWriters;
    io(s.object, p, &P::object, &P::set_object);
    io.messages(s.fields, p.mutable_fields(), 32);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<RecordedChange> s, proto::JournalChange& p) {
    using P = proto::JournalChange;
    io(s.object, p, &P::object, &P::set_object);
    io(s.mask, p, &P::mask, &P::set_mask);
    io.messages(s.writers_before, p.mutable_writers_before(), 32);
    io.messages(s.writers_after, p.mutable_writers_after(), 32);
    constexpr std::uint32_t Name = 1;
    const bool update = s.before && s.after && s.before->index() == s.after->index();
    if constexpr (std::is_same_v<Io, Writer>) {
        const auto put = [&](const scene::Object& object, proto::Entry& to) {
            if (update) {
                write(scene::Update{s.object, s.mask | Name, object}, to);
            } else {
                write(scene::Create{s.object, object}, to);
            }
        };
        if (s.before) put(*s.before, *p.mutable_before());
        if (s.after) put(*s.after, *p.mutable_after());
    } else {
        (void)update;
        const auto get = [&](proto::Entry& from) {
            scene::Entry entry = read(from);
            if (auto* created = std::get_if<scene::Create>(&entry)) return std::move(created->object);
            if (auto* updated = std::get_if<scene::Update>(&entry)) return std::move(updated->fields);
            malformed("a transaction's object has no state");
        };
        if (p.has_before()) s.before = get(*p.mutable_before());
        if (p.has_after()) s.after = get(*p.mutable_after());
    }
}

template <class Io>
void map(const Io& io, typename Io::template Ref<RecordedTransaction> s, proto::JournalTransaction& p) {
    using P = proto::JournalTransaction;
    io(s.number, p, &P::number, &P::set_number);
    io(s.editor, p, &P::editor, &P::set_editor);
    io(s.nature, p, &P::nature, &P::set_nature);
    io(s.author, p, &P::author, &P::set_author);
    io(s.gesture, p, &P::gesture, &P::set_gesture);
    io(s.edits, p, &P::edits, &P::set_edits);
    io(s.undoes, p, &P::undoes, &P::set_undoes);
    io(s.undone_by, p, &P::undone_by, &P::set_undone_by);
    io.text(s.text, p.mutable_text());
    io.messages(s.changes, p.mutable_changes(), MaxRecorded);
}

template <class Io>
void map(const Io& io, typename Io::template Ref<SavedView> s, proto::JournalView& p) {
    using P = proto::JournalView;
    io.text(s.name, p.mutable_name());
    io.text(s.owner_user, p.mutable_owner_user());
    io(s.owner_key, p, &P::owner_key, &P::set_owner_key);
    io(s.number, p, &P::number, &P::set_number);
    io.message(s.view, p.mutable_view());
    io(s.spp, p, &P::spp, &P::set_spp);
    io.message(s.scene_hash_of_film, p.mutable_scene_hash_of_film());
}

}  // namespace tessera::wire
