#pragma once

#include <deque>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "mediator/base/random.h"
#include "mediator/net/channel.h"
#include "mediator/wire/messages.h"

namespace tessera::test {

// How far the messages of peers got.
struct Reached {
    std::uint64_t edits = 0;     // accepted
    std::uint64_t requests = 0;  // accepted, of all other kinds
    std::uint64_t frames = 0;    // of views of theirs
    std::uint64_t units = 0;     // dealt to them
    Reached& operator+=(const Reached& other);
};

// A peer that sends valid messages of its role in any order, with any legal values: what it learns from the answers
// (ids, versions, units) it puts into later messages, so that they reach further than random numbers would. One thread.
class RandomPeer {
  public:
    struct Settings {
        net::Role role = net::Role::Viewer;
        std::string name;
        bool joins = true;  // scenes; else it is a client outside
        bool may_forge =
            true;  // film that is plausible and wrong: no one can tell without rendering it again
        ObjectId
            spared{};  // objects from this id on belong to others: it may touch them, too, but locks refuse it
    };
    RandomPeer(std::unique_ptr<net::Channel> channel, const Settings& settings, std::uint64_t seed);

    // Reads what has come, then sends one message. False: the link is full or closed, nothing was sent.
    bool act();
    void read();
    void say_goodbye();
    std::uint64_t sent() const { return sent_; }
    const Reached& reached() const { return reached_; }

  private:
    bool send(const wire::ControlMessage& message);
    bool send(const wire::BulkMessage& message);
    void greet();
    void take(const wire::ControlMessage& message);
    bool send_control();
    bool send_bulk();
    template <class Message>
    void adjust(Message& message);
    void adjust_view(session::ViewRequest& wanted);
    void adjust_edit(scene::Edit& edit);
    std::vector<scene::Entry> plain_entries(std::uint64_t sequence);
    void answered(const wire::EditReply& reply);
    wire::FilmPart film();
    ObjectId some_object();
    Version some_version();
    std::uint64_t extreme();  // a number that is often at an edge
    bool chance(unsigned percent) { return random_.below(100) < percent; }

    std::unique_ptr<net::Channel> channel_;
    Settings settings_;
    CounterRandom random_;
    std::uint64_t sent_ = 0;
    Reached reached_;
    bool greeted_ = false, welcome_ = false, joined_ = false;
    std::uint64_t token_ = 0, sequence_ = 0, first_id_ = 0, id_count_ = 0;
    Version version_;
    Hash128 state_hash_;
    struct WaitingEdit {
        std::vector<ObjectId> created, removed;
    };
    std::map<std::uint64_t, WaitingEdit> waiting_;  // by sequence
    std::set<ObjectId> created_;                    // by edits that were accepted
    std::uint64_t next_object_ = 0;
    std::vector<Hash256> blobs_;  // that the master named
    // of a node
    std::deque<view::WorkUnit> units_;
    std::deque<wire::OpenView> views_;
};

}  // namespace tessera::test
