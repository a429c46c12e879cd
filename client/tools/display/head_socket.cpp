#include "client/tools/display/head_socket.h"

#include <netdb.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <memory>
#include <string_view>
#include <system_error>

#include "client/tools/display/head_packet.h"

namespace tessera::tools {

namespace {

constexpr int MostPackets = 1000;

struct Sender {
    sockaddr_storage address{};
    socklen_t size = sizeof(sockaddr_storage);

    sockaddr* get() { return reinterpret_cast<sockaddr*>(&address); }
    const sockaddr* get() const { return reinterpret_cast<const sockaddr*>(&address); }
    std::string text() const {
        char host[NI_MAXHOST], service[NI_MAXSERV];
        if (::getnameinfo(get(), size, host, sizeof host, service, sizeof service,
                          NI_NUMERICHOST | NI_NUMERICSERV) != 0)
            return "an unknown sender";
        return std::string(host) + " port " + service;
    }
};

}  // namespace

HeadSocket::HeadSocket(const std::string& address, std::uint16_t port) {
    const addrinfo wanted{.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV | AI_PASSIVE,
                          .ai_family = AF_UNSPEC,
                          .ai_socktype = SOCK_DGRAM};
    addrinfo* list = nullptr;
    if (::getaddrinfo(address.c_str(), std::to_string(port).c_str(), &wanted, &list) != 0)
        throw Error(ErrorCode::InvalidInput,
                    "'" + address + "' is not a numeric address: give one of this machine, as 127.0.0.1");
    const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> found(list, &::freeaddrinfo);
    socket_ = ::socket(found->ai_family, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (socket_ < 0 || ::bind(socket_, found->ai_addr, found->ai_addrlen) != 0) {
        const std::string reason = std::generic_category().message(errno);
        if (socket_ >= 0) ::close(socket_);
        throw Error(ErrorCode::Unavailable, "cannot listen on " + address + " port " + std::to_string(port) +
                                                ": " + reason + ": choose another one");
    }
}

HeadSocket::~HeadSocket() {
    ::close(socket_);
}

std::uint16_t HeadSocket::port() const {
    Sender self;
    ::getsockname(socket_, self.get(), &self.size);
    const auto port = self.address.ss_family == AF_INET6
                          ? reinterpret_cast<const sockaddr_in6*>(self.get())->sin6_port
                          : reinterpret_cast<const sockaddr_in*>(self.get())->sin_port;
    return ntohs(port);
}

void HeadSocket::wait(Duration limit) const {
    pollfd entry{.fd = socket_, .events = POLLIN, .revents = 0};
    ::poll(&entry, 1, static_cast<int>(std::chrono::ceil<std::chrono::milliseconds>(limit).count()));
}

HeadSocket::Packets HeadSocket::drain() {
    Packets packets;
    std::array<char, MaxHeadPacket + 1>
        room{};  // longer packets are truncated, and still detected as too long
    for (int i = 0; i < MostPackets; ++i) {
        Sender sender;
        const ssize_t size = ::recvfrom(socket_, room.data(), room.size(), 0, sender.get(), &sender.size);
        if (size < 0) break;
        const auto head = parse_head(std::string_view(room.data(), static_cast<std::size_t>(size)));
        if (head) {
            packets.newest = *head;
            ++packets.good;
        } else {
            ++packets.bad;
            packets.problem = "from " + sender.text() + ": " + head.error().what();
        }
    }
    return packets;
}

}  // namespace tessera::tools
