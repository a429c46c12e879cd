#include "mediator/net/zmq_link.h"

#include <sys/eventfd.h>
#include <unistd.h>
#include <zmq.h>

#include <algorithm>
#include <charconv>

namespace tessera::net {

namespace {

constexpr int QueuedControl = 4096;  // messages of at most 64 KiB, mostly below 1 KiB
constexpr int QueuedBulk = 64;       // messages of at most 1 MiB
constexpr int LingerMilliseconds = 1000;
constexpr int HandshakeMilliseconds = 5000;

Error bad_endpoint(const std::string& endpoint) {
    return Error(ErrorCode::InvalidInput,
                 "'" + endpoint +
                     "' is no address: expected tcp://host:port with a port between 1 and "
                     "65534 (bulk data use the next one)");
}

}  // namespace

Addresses addresses_of(const std::string& endpoint) {
    if (endpoint.starts_with("inproc://") && endpoint.size() > 9)
        return {endpoint, endpoint + ".bulk", false, false};
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
    return {address(port), address(port + 1), true, host.starts_with("127.") || host == "[::1]"};
}

std::size_t limit_of(Link link) {
    return link == Link::Control ? ControlLimit : BulkLimit;
}

void configure(zmq::socket_t& socket, Link link) {
    const int queued = link == Link::Control ? QueuedControl : QueuedBulk;
    socket.set(zmq::sockopt::sndhwm, queued);
    socket.set(zmq::sockopt::rcvhwm, queued);
    socket.set(zmq::sockopt::linger, LingerMilliseconds);
    socket.set(zmq::sockopt::maxmsgsize, static_cast<std::int64_t>(limit_of(link)));
    socket.set(zmq::sockopt::handshake_ivl, HandshakeMilliseconds);
    socket.set(zmq::sockopt::ipv6, true);
    socket.set(zmq::sockopt::tcp_keepalive, 1);
    socket.set(zmq::sockopt::reconnect_ivl, 100);
    socket.set(zmq::sockopt::reconnect_ivl_max, 5000);
    if (zmq::socket_type(socket.get(zmq::sockopt::type)) == zmq::socket_type::router) {
        socket.set(zmq::sockopt::router_mandatory, true);
    }
}

WakeSignal::WakeSignal() : descriptor_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
    if (descriptor_ < 0)
        throw Error(ErrorCode::Internal, "no event descriptor: raise the limit of open files");
}

WakeSignal::~WakeSignal() {
    close(descriptor_);
}

void WakeSignal::raise() {
    const std::uint64_t one = 1;
    [[maybe_unused]] const auto written = write(descriptor_, &one, sizeof one);  // full means: raised already
}

bool WakeSignal::take() {
    std::uint64_t count = 0;
    return read(descriptor_, &count, sizeof count) == sizeof count;
}

void wait_readable(std::array<zmq::socket_t, 2>& sockets, const WakeSignal& signal, TimePoint deadline) {
    const TimePoint now = std::chrono::steady_clock::now();
    constexpr std::int64_t LongestWait = 60'000;
    std::int64_t wait = 0;
    if (deadline > now) {
        // Rounded up: a wait that ends early would only spin.
        wait = deadline - now > std::chrono::milliseconds(LongestWait)
                   ? LongestWait
                   : std::chrono::ceil<std::chrono::milliseconds>(deadline - now).count();
    }
    std::array<zmq::pollitem_t, 3> items{{{sockets[0].handle(), 0, ZMQ_POLLIN, 0},
                                          {sockets[1].handle(), 0, ZMQ_POLLIN, 0},
                                          {nullptr, signal.descriptor(), ZMQ_POLLIN, 0}}};
    zmq_poll(items.data(), static_cast<int>(items.size()), static_cast<long>(wait));
}

}  // namespace tessera::net
