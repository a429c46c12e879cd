#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "mediator/net/zmq_channel.h"

namespace tessera::net {

TimePoint in(Duration duration);  // from now

// The server's endpoint is tcp://127.0.0.1 on two free ports; retries if other processes take them.
struct TcpServer {
    std::unique_ptr<ZmqServer> channel;
    std::string endpoint, bulk_endpoint;
};
TcpServer make_tcp_server(const std::shared_ptr<ZmqContext>& context,
                          const std::optional<KeyDirectory>& keys = std::nullopt);

Bytes numbered(std::uint64_t number, std::size_t size = sizeof(std::uint64_t));
std::uint64_t number_of(const Bytes& bytes);

// Sends, reading nothing, until it is Sent or Closed; WouldBlock after a generous while.
SendResult send_patiently(Channel& channel, Link link, PeerId peer, Bytes bytes);

// The next message, ignoring wakes; nothing after `limit`.
std::optional<Message> next_message(Channel& channel, Duration limit = std::chrono::seconds(10));

// A temporary folder, removed by the destructor.
class TemporaryFolder {
  public:
    TemporaryFolder();
    ~TemporaryFolder();
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

  private:
    std::filesystem::path path_;
};

// Is it true within `limit`?
bool eventually(const std::function<bool()>& condition, Duration limit = std::chrono::seconds(10));

}  // namespace tessera::net
