#include "mediator/net/zap.h"

#include <signal.h>
#include <zmq.h>

#include <array>
#include <zmq_addon.hpp>

namespace tessera::net {

namespace {

constexpr const char* Endpoint = "inproc://zeromq.zap.01";  // the endpoint used by libzmq, RFC 27

std::string z85(const zmq::message_t& binary) {
    if (binary.size() != 32) return {};
    std::array<char, 41> text{};
    zmq_z85_encode(text.data(), binary.data<std::uint8_t>(), 32);
    return text.data();
}

}  // namespace

std::string user_id(const AllowedKey& key) {
    return std::string(name(key.role)) + ":" + key.name + ":" + key.public_key;
}

User user_of(const std::string& user_id) {
    const std::size_t first = user_id.find(':');
    if (first == std::string::npos) return {};
    const std::size_t second = user_id.find(':', first + 1);
    if (second == std::string::npos) return {};
    return {role_named(std::string_view(user_id).substr(0, first)),
            user_id.substr(first + 1, second - first - 1)};
}

ZapHandler::ZapHandler(zmq::context_t& context)
    : socket_(context, zmq::socket_type::rep),
      stop_sender_(context, zmq::socket_type::pair),
      stop_receiver_(context, zmq::socket_type::pair) {
    socket_.set(zmq::sockopt::linger, 0);
    socket_.bind(Endpoint);
    const std::string stop = "inproc://zap-stop";
    stop_receiver_.bind(stop);
    stop_sender_.connect(stop);
    // Signals are handled by the program's other threads.
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    thread_ = std::thread([this] { run(); });
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

ZapHandler::~ZapHandler() {
    stop_sender_.send(zmq::message_t(), zmq::send_flags::dontwait);
    thread_.join();
}

void ZapHandler::run() {
    std::array<zmq::pollitem_t, 2> items{
        {{socket_.handle(), 0, ZMQ_POLLIN, 0}, {stop_receiver_.handle(), 0, ZMQ_POLLIN, 0}}};
    while (true) {
        zmq::poll(items.data(), items.size(), std::chrono::milliseconds(-1));
        if ((items[1].revents & ZMQ_POLLIN) != 0) return;
        std::vector<zmq::message_t> request;
        if (zmq::recv_multipart(socket_, std::back_inserter(request))) answer(request);
    }
}

// A request is: version, request id, domain, address, identity, mechanism, credentials.
void ZapHandler::answer(const std::vector<zmq::message_t>& request) {
    std::optional<std::string> user;
    if (request.size() == 7 && request[0].to_string_view() == "1.0" &&
        request[5].to_string_view() == "CURVE") {
        user = admit(request[2].to_string(), z85(request[6]));
    }
    const std::string request_id = request.size() > 1 ? request[1].to_string() : std::string();
    const std::array<std::string, 6> reply{
        "1.0", request_id, user ? "200" : "400", user ? "OK" : "unknown key", user.value_or(""), ""};
    for (std::size_t i = 0; i < reply.size(); ++i) {
        socket_.send(zmq::buffer(reply[i]),
                     i + 1 < reply.size() ? zmq::send_flags::sndmore : zmq::send_flags::none);
    }
}

std::optional<std::string> ZapHandler::admit(const std::string& domain, const std::string& public_key) {
    const std::scoped_lock lock(mutex_);
    const auto list = domains_.find(domain);
    if (list == domains_.end()) return std::nullopt;
    const auto user = list->second.user_id_by_key.find(public_key);
    if (user != list->second.user_id_by_key.end()) return user->second;
    ++list->second.refused;
    return std::nullopt;
}

std::uint64_t ZapHandler::refused(const std::string& domain) const {
    const std::scoped_lock lock(mutex_);
    const auto list = domains_.find(domain);
    return list == domains_.end() ? 0 : list->second.refused;
}

void ZapHandler::allow(const std::string& domain, const std::vector<AllowedKey>& keys) {
    Domain list;
    for (const AllowedKey& key : keys) {
        list.user_id_by_key[key.public_key] = user_id(key);
        list.user_ids.insert(user_id(key));
    }
    const std::scoped_lock lock(mutex_);
    list.refused = domains_[domain].refused;
    domains_[domain] = std::move(list);
}

void ZapHandler::forget(const std::string& domain) {
    const std::scoped_lock lock(mutex_);
    domains_.erase(domain);
}

bool ZapHandler::is_allowed(const std::string& domain, const std::string& user_id) const {
    const std::scoped_lock lock(mutex_);
    const auto list = domains_.find(domain);
    return list != domains_.end() && list->second.user_ids.contains(user_id);
}

}  // namespace tessera::net
