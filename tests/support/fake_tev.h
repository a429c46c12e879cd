#pragma once

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "mediator/base/rect.h"

namespace tessera::test {

// Understands the packets of one client of the image viewer tev (client/tools/tev/packets.h).
class FakeTev {
  public:
    FakeTev() {
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        EXPECT_EQ(::bind(listener_, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
        EXPECT_EQ(::listen(listener_, 1), 0);
        socklen_t size = sizeof address;
        ::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size);
        port_ = ntohs(address.sin_port);
    }
    ~FakeTev() {
        ::close(listener_);
        if (connection_ >= 0) ::close(connection_);
    }
    std::string address() const { return "127.0.0.1:" + std::to_string(port_); }
    void hang_up() { ::close(std::exchange(connection_, -1)); }

    // Until `count` packets have come, or all until the client hangs up.
    void read(int count = std::numeric_limits<int>::max()) {
        if (connection_ < 0) {
            constexpr int Minute = 60'000;
            pollfd entry{.fd = listener_, .events = POLLIN, .revents = 0};
            ASSERT_EQ(::poll(&entry, 1, Minute), 1) << "nothing connects";
            connection_ = ::accept(listener_, nullptr, nullptr);
        }
        for (int i = 0; i < count; ++i) {
            std::uint32_t size = 0;
            if (!receives(&size, sizeof size)) return;
            ASSERT_GT(size, sizeof size);
            packet_.resize(size - sizeof size);
            ASSERT_TRUE(receives(packet_.data(), packet_.size()));
            at_ = 0;
            take();
            EXPECT_EQ(at_, packet_.size());
        }
    }

    std::string name;
    std::int32_t width = 0, height = 0;
    std::vector<std::string> channels;
    std::map<std::string, std::vector<float>> planes;
    int created = 0, updated = 0;

  private:
    bool receives(void* to, std::size_t size) const {
        return ::recv(connection_, to, size, MSG_WAITALL) == static_cast<ssize_t>(size);
    }
    template <class Number>
    Number number() {
        Number value{};
        EXPECT_LE(at_ + sizeof value, packet_.size());
        std::memcpy(&value, packet_.data() + at_, sizeof value);
        at_ += sizeof value;
        return value;
    }
    std::string text() {
        const std::string value(packet_.data() + at_);
        at_ += value.size() + 1;
        return value;
    }
    void take() {
        const auto kind = number<std::uint8_t>();
        number<std::uint8_t>();
        name = text();
        if (kind == 4) {
            ++created;
            width = number<std::int32_t>();
            height = number<std::int32_t>();
            channels.resize(static_cast<std::size_t>(number<std::int32_t>()));
            for (std::string& channel : channels) channel = text();
            for (const std::string& channel : channels)
                planes[channel].assign(static_cast<std::size_t>(width * height), 0.0f);
            return;
        }
        EXPECT_EQ(kind, 6);
        ++updated;
        EXPECT_EQ(number<std::int32_t>(), static_cast<std::int32_t>(channels.size()));
        for (const std::string& channel : channels) EXPECT_EQ(text(), channel);
        const Rect part{number<std::int32_t>(), number<std::int32_t>(), number<std::int32_t>(),
                        number<std::int32_t>()};
        std::vector<std::int64_t> offsets;
        for (std::size_t i = 0; i < channels.size(); ++i) offsets.push_back(number<std::int64_t>());
        for (std::size_t i = 0; i < channels.size(); ++i) EXPECT_EQ(number<std::int64_t>(), 1);
        for (std::size_t i = 0; i < channels.size(); ++i) {
            EXPECT_EQ(offsets[i], static_cast<std::int64_t>(i * part.pixel_count()));
            for (std::int32_t y = part.y; y < part.bottom(); ++y)
                for (std::int32_t x = part.x; x < part.right(); ++x)
                    planes[channels[i]][static_cast<std::size_t>(y * width + x)] = number<float>();
        }
    }

    int listener_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0), connection_ = -1;
    std::uint16_t port_ = 0;
    std::vector<char> packet_;
    std::size_t at_ = 0;
};

}  // namespace tessera::test
