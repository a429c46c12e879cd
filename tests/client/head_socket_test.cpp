#include "client/tools/display/head_socket.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include "mediator/base/error.h"

namespace tessera::tools {
namespace {

using namespace std::chrono_literals;

struct Tracker {
    int socket = ::socket(AF_INET, SOCK_DGRAM, 0);
    sockaddr_in to{};

    explicit Tracker(const HeadSocket& heads) {
        to.sin_family = AF_INET;
        to.sin_port = htons(heads.port());
        to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    }
    ~Tracker() { ::close(socket); }
    void say(const std::string& packet) const {
        ASSERT_EQ(::sendto(socket, packet.data(), packet.size(), 0, reinterpret_cast<const sockaddr*>(&to),
                           sizeof to),
                  static_cast<ssize_t>(packet.size()));
    }
};

TEST(HeadSocket, NewestValidPacketWinsAndBadOnesAreCounted) {
    HeadSocket heads("127.0.0.1", 0);
    const Tracker tracker(heads);
    EXPECT_FALSE(heads.drain().newest);
    for (int i = 1; i <= 20; ++i) tracker.say(std::to_string(i) + " 0 0");
    tracker.say("");
    tracker.say("lost");
    tracker.say(std::string(513, ' '));
    tracker.say(std::string(60000, '1'));
    heads.wait(10s);
    const HeadSocket::Packets packets = heads.drain();
    ASSERT_TRUE(packets.newest);
    EXPECT_EQ(packets.newest->position, glm::dvec3(20, 0, 0));
    EXPECT_EQ(packets.good, 20u);
    EXPECT_EQ(packets.bad, 4u);
    EXPECT_NE(packets.problem.find("from 127.0.0.1 port "), std::string::npos) << packets.problem;
    EXPECT_NE(packets.problem.find("longer than 512"), std::string::npos) << packets.problem;
    EXPECT_EQ(heads.drain().good, 0u);
}

TEST(HeadSocket, WaitsForAPacketOrTheTimeout) {
    HeadSocket heads("127.0.0.1", 0);
    heads.wait(1ms);
    EXPECT_EQ(heads.drain().good, 0u);
    const Tracker tracker(heads);
    tracker.say("1 2 3");
    heads.wait(1min);
    EXPECT_EQ(heads.drain().good, 1u);
}

TEST(HeadSocket, UnavailableAddressesAreErrors) {
    const auto code = [](const std::string& address, std::uint16_t port) {
        try {
            const HeadSocket heads(address, port);
        } catch (const Error& error) {
            return error.code();
        }
        return ErrorCode::Internal;
    };
    const HeadSocket first("127.0.0.1", 0);
    EXPECT_EQ(code("127.0.0.1", first.port()), ErrorCode::Unavailable);
    EXPECT_EQ(code("192.0.2.1", 0), ErrorCode::Unavailable);  // not assigned: RFC 5737
    EXPECT_EQ(code("localhost", 0), ErrorCode::InvalidInput);
    EXPECT_EQ(code("", 0), ErrorCode::InvalidInput);
}

}  // namespace
}  // namespace tessera::tools
