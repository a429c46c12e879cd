#include "mediator/net/zmq_link.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/eventfd.h>
#include <unistd.h>
#include <zmq.h>

#include <cerrno>
#include <charconv>

namespace tessera::net {

namespace {

constexpr std::size_t CurveOverhead = 33;  // of RFC 26's MESSAGE; libzmq counts it when it limits sizes
constexpr int LingerMilliseconds = 1000;
constexpr int HandshakeMilliseconds = 5000;

Error bad_endpoint(const std::string& endpoint) {
    return Error(ErrorCode::InvalidInput,
                 "'" + endpoint +
                     "' is not an address: expected tcp://host:port with a port between 1 and "
                     "65534 (bulk data use the next one)");
}

bool is_loopback_address(const std::string& host) {
    in_addr v4{};
    in6_addr v6{};
    if (inet_pton(AF_INET, host.c_str(), &v4) == 1) return (ntohl(v4.s_addr) >> 24) == 127;
    if (host.size() < 2 || host.front() != '[' || host.back() != ']') return false;
    return inet_pton(AF_INET6, host.substr(1, host.size() - 2).c_str(), &v6) == 1 &&
           IN6_IS_ADDR_LOOPBACK(&v6);
}

[[noreturn]] void fail(const char* what) {
    throw Error(ErrorCode::Internal, std::string(what) + ": " + zmq_strerror(zmq_errno()));
}

// Retries if a signal interrupts the call.
template <class Call>
int uninterrupted(const Call& call) {
    int result = 0;
    do result = call();
    while (result < 0 && zmq_errno() == EINTR);
    return result;
}

}  // namespace

Addresses addresses_of(const std::string& endpoint) {
    if (endpoint.starts_with("inproc://") && endpoint.size() > 9)
        return {.control = endpoint, .bulk = endpoint + ".bulk"};
    const std::size_t colon = endpoint.rfind(':');
    if (!endpoint.starts_with("tcp://") || colon <= 6 || colon == std::string::npos)
        throw bad_endpoint(endpoint);
    std::string host = endpoint.substr(6, colon - 6);
    int port = 0;
    const char* end = endpoint.data() + endpoint.size();
    const auto [parsed, error] = std::from_chars(endpoint.data() + colon + 1, end, port);
    if (error != std::errc() || parsed != end || port < 1 || port > 65534) throw bad_endpoint(endpoint);
    if (host == "localhost") host = "127.0.0.1";  // a bind takes addresses only
    const auto address = [&](int number) { return "tcp://" + host + ":" + std::to_string(number); };
    return {address(port), address(port + 1), true, is_loopback_address(host), host.front() == '['};
}

std::size_t limit_of(Link link) {
    return link == Link::Control ? ControlLimit : BulkLimit;
}

void require_keys(const std::string& endpoint, const Addresses& addresses, Keys keys) {
    if (!addresses.is_tcp || addresses.is_loopback || keys == Keys::Present) return;
    throw Error(ErrorCode::Refused, "'" + endpoint +
                                        "' is on the network, and without keys nothing is encrypted: give "
                                        "--keys (made by 'tessera keys'), or use an address of this machine");
}

int queue_limit(Link link) {
    return static_cast<int>(QueueBudget / limit_of(link));
}

void configure(zmq::socket_t& socket, Link link, const Addresses& addresses) {
    socket.set(zmq::sockopt::sndhwm, queue_limit(link));
    socket.set(zmq::sockopt::rcvhwm, queue_limit(link));
    socket.set(zmq::sockopt::linger, LingerMilliseconds);
    socket.set(zmq::sockopt::maxmsgsize, static_cast<std::int64_t>(limit_of(link) + CurveOverhead));
    socket.set(zmq::sockopt::handshake_ivl, HandshakeMilliseconds);
    socket.set(zmq::sockopt::tcp_keepalive, 1);
    socket.set(zmq::sockopt::reconnect_ivl, 100);
    socket.set(zmq::sockopt::reconnect_ivl_max, 5000);
    const bool is_server = zmq::socket_type(socket.get(zmq::sockopt::type)) == zmq::socket_type::router;
    if (is_server) socket.set(zmq::sockopt::router_mandatory, true);
    // A server on "*" listens on IPv4 and IPv6. A client resolves its host name as IPv4: libzmq tries only one address,
    // and a name often has an IPv6 address that the server does not listen on.
    socket.set(zmq::sockopt::ipv6, is_server || addresses.is_ipv6);
}

SendResult send_message(zmq::socket_t& socket, const std::string* routing_id, const Bytes& bytes) {
    const auto send = [&](const void* data, std::size_t size, int flags) {
        return uninterrupted([&] { return zmq_send(socket.handle(), data, size, flags | ZMQ_DONTWAIT); });
    };
    const auto failed = [] {
        if (zmq_errno() == EAGAIN) return SendResult::WouldBlock;
        if (zmq_errno() != EHOSTUNREACH) fail("cannot send");
        return SendResult::Closed;
    };
    if (routing_id != nullptr && send(routing_id->data(), routing_id->size(), ZMQ_SNDMORE) < 0)
        return failed();
    // Once ROUTER has accepted the routing id, it accepts the rest.
    return send(bytes.data(), bytes.size(), 0) < 0 ? failed() : SendResult::Sent;
}

bool receive_part(zmq::socket_t& socket, zmq::message_t& part) {
    part.rebuild();
    const int size =
        uninterrupted([&] { return zmq_msg_recv(part.handle(), socket.handle(), ZMQ_DONTWAIT); });
    if (size < 0 && zmq_errno() != EAGAIN) fail("cannot receive");
    return size >= 0;
}

WakeSignal::WakeSignal() : descriptor_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
    if (descriptor_ < 0)
        throw Error(ErrorCode::Internal, "no event descriptor: raise the limit of open files");
}

WakeSignal::~WakeSignal() {
    close(descriptor_);
}

void WakeSignal::raise() {
    raised_ = true;  // before the write: a thread that the write wakes finds it
    const std::uint64_t one = 1;
    [[maybe_unused]] const auto written = write(descriptor_, &one, sizeof one);  // full: already readable
}

void WakeSignal::drain() {
    std::uint64_t count = 0;
    [[maybe_unused]] const auto taken = read(descriptor_, &count, sizeof count);
}

void wait_readable(std::array<zmq::socket_t, 2>& sockets, WakeSignal& signal, TimePoint deadline) {
    const TimePoint now = std::chrono::steady_clock::now();
    constexpr std::int64_t LongestWait = 60'000;
    std::int64_t wait = 0;
    if (deadline > now) {
        // Rounded up: a wait that ends early would spin.
        wait = deadline - now > std::chrono::milliseconds(LongestWait)
                   ? LongestWait
                   : std::chrono::ceil<std::chrono::milliseconds>(deadline - now).count();
    }
    std::array<zmq::pollitem_t, 3> items{{{sockets[0].handle(), 0, ZMQ_POLLIN, 0},
                                          {sockets[1].handle(), 0, ZMQ_POLLIN, 0},
                                          {nullptr, signal.descriptor(), ZMQ_POLLIN, 0}}};
    zmq_poll(items.data(), static_cast<int>(items.size()), static_cast<long>(wait));
    if ((items[2].revents & ZMQ_POLLIN) != 0) signal.drain();
}

}  // namespace tessera::net
