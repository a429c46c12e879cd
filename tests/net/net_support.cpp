#include "tests/net/net_support.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstring>
#include <functional>
#include <stdexcept>
#include <thread>

namespace tessera::net {

namespace {

int free_port() {
    const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{.sin_family = AF_INET, .sin_addr = {.s_addr = htonl(INADDR_LOOPBACK)}};
    socklen_t length = sizeof address;
    auto* generic = reinterpret_cast<sockaddr*>(&address);
    const bool found = bind(socket, generic, length) == 0 && getsockname(socket, generic, &length) == 0;
    close(socket);
    if (!found) throw std::runtime_error("no free port");
    return ntohs(address.sin_port);
}

}  // namespace

TimePoint in(Duration duration) {
    return std::chrono::steady_clock::now() + duration;
}

TcpServer make_tcp_server(const std::shared_ptr<ZmqContext>& context,
                          const std::optional<KeyDirectory>& keys) {
    for (int attempt = 0; attempt < 50; ++attempt) {
        const int port = free_port();
        if (port >= 65535) continue;
        const auto endpoint = [](int number) { return "tcp://127.0.0.1:" + std::to_string(number); };
        try {
            return {make_zmq_server(context, {.endpoint = endpoint(port), .keys = keys}), endpoint(port),
                    endpoint(port + 1)};
        } catch (const Error& error) {
            if (error.code() != ErrorCode::Unavailable) throw;
        }
    }
    throw std::runtime_error("no two free ports in a row");
}

Bytes numbered(std::uint64_t number, std::size_t size) {
    Bytes bytes(size);
    std::memcpy(bytes.data(), &number, sizeof number);
    return bytes;
}

std::uint64_t number_of(const Bytes& bytes) {
    std::uint64_t number = 0;
    if (bytes.size() >= sizeof number) std::memcpy(&number, bytes.data(), sizeof number);
    return number;
}

SendResult send_patiently(Channel& channel, Link link, PeerId peer, Bytes bytes) {
    SendResult result = SendResult::WouldBlock;
    eventually([&] {
        result = channel.send(link, peer, std::move(bytes));
        return result != SendResult::WouldBlock;
    });
    return result;
}

std::optional<Message> next_message(Channel& channel, Duration limit) {
    const TimePoint deadline = in(limit);
    while (true) {
        Received received = channel.receive(deadline);
        if (auto* message = std::get_if<Message>(&received)) return std::move(*message);
        if (std::get<NoMessage>(received) != NoMessage::Woken) return std::nullopt;
    }
}

TemporaryFolder::TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "tessera-test-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
}

bool eventually(const std::function<bool()>& condition, Duration limit) {
    const TimePoint deadline = in(limit);
    while (!condition()) {
        if (std::chrono::steady_clock::now() > deadline) return false;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return true;
}

}  // namespace tessera::net
