#pragma once

#include <deque>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mediator/net/channel.h"
#include "tests/fuzz/edit_generator.h"
#include "tests/fuzz/film_generator.h"
#include "tests/fuzz/traffic.h"

namespace tessera::test {

// How far the messages of peers got.
struct Reached {
    std::uint64_t edits = 0;     // accepted
    std::uint64_t requests = 0;  // accepted, of all other kinds
    std::uint64_t frames = 0;    // of views of theirs
    std::uint64_t units = 0;     // dealt to them
    Reached& operator+=(const Reached& other);
};

// A peer that sends valid messages of its role in any order, with any legal values, many of them such that follow from
// what it learned from the answers. Half of its messages are of the kind that all peers have sent least. One thread.
class RandomPeer {
  public:
    struct Settings {
        net::Role role = net::Role::Viewer;
        std::string name;
        bool joins = true;  // the shared scene; else it stays outside, and tries to close that of others
        bool may_forge =
            true;           // film that is plausible and wrong: no one can tell without rendering it again
        ObjectId spared{};  // from here on objects belong to others
    };
    RandomPeer(std::unique_ptr<net::Channel> channel, const Settings& settings, Traffic& traffic,
               std::uint64_t& highest_unit, std::uint64_t seed);

    // Names of all messages that peers of these roles send.
    static std::set<std::string_view> kinds(std::span<const net::Role> roles);

    // Reads what has come, then sends one message. False: the link is full or closed, nothing was sent.
    bool act();
    void read();
    void say_goodbye();
    std::uint64_t sent() const { return sent_; }
    Reached reached() const { return {edits_.accepted(), requests_, frames_, film_.dealt()}; }
    // What it got and must not get; "" if nothing.
    const std::string& leak() const { return leak_; }

  private:
    bool send(const wire::ControlMessage& message);
    bool send(const wire::BulkMessage& message);
    void greet();
    void take(const wire::ControlMessage& message);
    void take(const wire::BulkMessage& message);
    void ask_for_work();
    bool send_rarest();
    bool send_filled(wire::ControlMessage message);
    bool send_edit();
    bool offer(wire::SubmitEditByBlob&& edit, std::vector<std::byte>&& bytes);
    wire::BulkMessage filled(wire::BulkMessage message);
    template <class Message>
    void adjust(Message& message);
    void adjust_view(session::ViewRequest& wanted);
    wire::EarlierFilm earlier_film(const session::ViewRequest& wanted);
    std::string view_name() { return "view " + std::to_string(random_.below(8)); }

    std::unique_ptr<net::Channel> channel_;
    Settings settings_;
    Traffic& traffic_;
    RandomValues random_;
    EditGenerator edits_;
    FilmGenerator film_;
    std::uint64_t sent_ = 0, requests_ = 0, frames_ = 0, token_ = 0;
    bool greeted_ = false, welcome_ = false, joined_ = false;
    std::deque<Hash256> blobs_;  // that the master named
    struct Offered {
        Hash256 hash;
        std::vector<std::byte> bytes;
    };
    std::deque<Offered> offered_;  // for the master to fetch
    std::string leak_;
};

}  // namespace tessera::test
