#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/channel_session.h"
#include "client/session.h"
#include "tests/client/scripted_master.h"

namespace tessera::client {

template <class Call>
auto in_background(Call call) {
    return std::async(std::launch::async, std::move(call));
}

template <class Future>
void expect_error(Future& future, ErrorCode code) {
    try {
        (void)future.get();
        FAIL() << "no error";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), code) << error.what();
    }
}

inline std::vector<scene::Entry> material(std::size_t name_length) {
    return {scene::Create{ObjectId{65536}, scene::Material{.name = std::string(name_length, 'm')}}};
}

// A session connected to a scripted master over loopback.
class WithScriptedMaster : public testing::Test {
  protected:
    std::future<std::unique_ptr<Session>> connect(SessionSettings settings = {}) {
        return std::async(std::launch::async, [this, settings] {
            return make_session(
                hub_.client(net::Role::Editor), [this] { ++reconnects_; }, blobs_, clock_, settings);
        });
    }
    std::unique_ptr<Session> connected() {
        auto session = connect();
        master_.greet();
        return session.get();
    }
    // In an exclusive scene.
    std::unique_ptr<Session> joined(SessionSettings settings = {},
                                    const std::optional<wire::Welcome>& welcome = {}) {
        auto connecting = connect(std::move(settings));
        welcome ? master_.greet(*welcome) : master_.greet();
        auto session = connecting.get();
        auto joining = std::async(std::launch::async,
                                  [&] { return session->join({.title = "a", .exclusive = true}, {}); });
        EXPECT_TRUE(master_.expect<wire::JoinScene>().exclusive);
        master_.send(Scene);
        EXPECT_TRUE(std::holds_alternative<Joined>(joining.get()));
        return session;
    }
    // Receives the request for a view.
    wire::RequestView view_requested() {
        const auto request = master_.expect<wire::RequestView>();
        master_.send(wire::RequestDone{request.request, true, {}});
        return request;
    }
    static wire::Welcome quick_welcome() {
        return {.peer_number = 7,
                .token = 70,
                .epoch = 1,
                .heartbeat_interval = std::chrono::milliseconds(200),
                .missed_heartbeats = 3};
    }

    static inline const wire::SceneJoined Scene{
        .version = {1, 5}, .first_id = 65536, .id_count = 100, .title = "a", .name = "client"};

    SteadyClock clock_;
    std::shared_ptr<scene::BlobStore> blobs_ = std::make_shared<scene::BlobStore>();
    net::LoopbackHub hub_;
    ScriptedMaster master_{hub_};
    std::atomic<int> reconnects_ = 0;
};

}  // namespace tessera::client
