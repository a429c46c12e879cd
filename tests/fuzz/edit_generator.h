#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <vector>

#include "mediator/wire/messages.h"
#include "tests/fuzz/random_values.h"

namespace tessera::test {

// What an editor knows of the scene, and edits that follow from it: its answers name versions and ids, which later edits
// use, so that they reach further than random numbers would.
class EditGenerator {
  public:
    // Objects from `spared` on belong to others: they are edited, too, but locks refuse it.
    EditGenerator(RandomValues& random, ObjectId spared) : random_(random), spared_(spared) {}

    void joined(const wire::SceneJoined& scene);
    void answered(const wire::EditReply& reply);
    void learned(Version version) { version_ = version; }
    void learned(Version version, Hash128 state_hash) { version_ = version, state_hash_ = state_hash; }
    void renewed(std::uint64_t epoch) { version_.epoch = epoch; }

    // As encoded; long ones repeat their entries, which takes no memory here.
    struct Encoded {
        wire::SubmitEditByBlob head;  // its blob is left to the sender
        std::vector<std::byte> bytes;
    };
    Encoded long_edit();
    scene::Edit edit();
    ObjectId some_object();
    Version some_version();
    Version version() const { return version_; }
    Hash128 state_hash() const { return state_hash_; }
    std::uint64_t accepted() const { return accepted_; }

  private:
    std::vector<scene::Entry> random_entries();
    std::vector<scene::Entry> plain_entries(std::uint64_t sequence);
    std::vector<scene::Entry> deep_entries();
    std::vector<scene::Entry> many_entries(std::size_t count);
    ObjectId new_id();

    RandomValues& random_;
    ObjectId spared_;
    Version version_;
    Hash128 state_hash_;
    std::uint64_t sequence_ = 0, first_id_ = 0, id_count_ = 0, next_object_ = 0, accepted_ = 0;
    struct WaitingEdit {
        std::vector<ObjectId> created, removed;
    };
    std::map<std::uint64_t, WaitingEdit> waiting_;  // by sequence
    std::set<ObjectId> created_;                    // by edits that were accepted
};

}  // namespace tessera::test
