#include "client/tools/tev/viewer.h"

#include <fcntl.h>
#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <memory>
#include <system_error>
#include <utility>

namespace tessera::tools::tev {

namespace {

constexpr int ConnectMilliseconds = 5000;
constexpr timeval SendLimit{.tv_sec = 10, .tv_usec = 0};

struct HostAndPort {
    std::string host, port = DefaultPort;
};

Expected<HostAndPort> parse(const std::string& address) {
    const auto wrong = tl::unexpected(
        Error(ErrorCode::InvalidInput,
              "'" + address + "' is not HOST, HOST:PORT or [HOST]:PORT, as localhost:" + DefaultPort));
    HostAndPort parsed;
    std::string rest = address;
    if (rest.starts_with('[')) {
        const std::size_t end = rest.find(']');
        if (end == std::string::npos) return wrong;
        parsed.host = rest.substr(1, end - 1);
        rest = rest.substr(end + 1);
    } else {
        const std::size_t end = std::min(rest.find(':'), rest.size());
        parsed.host = rest.substr(0, end);
        rest = rest.substr(end);
    }
    if (!rest.empty()) {
        if (rest.front() != ':') return wrong;
        parsed.port = rest.substr(1);
    }
    const bool is_number = !parsed.port.empty() && parsed.port.size() <= 5 &&
                           parsed.port.find_first_not_of("0123456789") == std::string::npos;
    if (parsed.host.empty() || !is_number) return wrong;
    return parsed;
}

// An errno; 0: it is connected.
int connect_within_limit(int socket, const addrinfo& to) {
    const int flags = ::fcntl(socket, F_GETFL);
    ::fcntl(socket, F_SETFL, flags | O_NONBLOCK);
    if (::connect(socket, to.ai_addr, to.ai_addrlen) != 0) {
        if (errno != EINPROGRESS) return errno;
        pollfd entry{.fd = socket, .events = POLLOUT, .revents = 0};
        if (::poll(&entry, 1, ConnectMilliseconds) <= 0) return ETIMEDOUT;
        int failure = 0;
        socklen_t size = sizeof failure;
        ::getsockopt(socket, SOL_SOCKET, SO_ERROR, &failure, &size);
        if (failure != 0) return failure;
    }
    ::fcntl(socket, F_SETFL, flags);
    return 0;
}

int connected_socket(const std::string& address) {
    const auto parsed = parse(address);
    if (!parsed) throw parsed.error();
    const HostAndPort& to = *parsed;
    const auto unavailable = [&](const std::string& reason) {
        return Error(ErrorCode::Unavailable, "cannot reach tev at " + address + ": " + reason +
                                                 ": start it there, or check the address");
    };
    const addrinfo wanted{.ai_flags = 0, .ai_family = AF_UNSPEC, .ai_socktype = SOCK_STREAM};
    addrinfo* list = nullptr;
    if (const int failure = ::getaddrinfo(to.host.c_str(), to.port.c_str(), &wanted, &list); failure != 0)
        throw unavailable(::gai_strerror(failure));
    const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> found(list, &::freeaddrinfo);
    int failure = 0;
    for (const addrinfo* one = found.get(); one != nullptr; one = one->ai_next) {
        const int socket = ::socket(one->ai_family, SOCK_STREAM | SOCK_CLOEXEC, 0);
        failure = socket < 0 ? errno : connect_within_limit(socket, *one);
        if (failure == 0) {
            ::setsockopt(socket, SOL_SOCKET, SO_SNDTIMEO, &SendLimit, sizeof SendLimit);
            return socket;
        }
        if (socket >= 0) ::close(socket);
    }
    throw unavailable(std::generic_category().message(failure));
}

// "albedo.R"; of the picture itself "R".
std::vector<std::string> channel_names(std::span<const picture::Layer> layers) {
    std::vector<std::string> names;
    for (const picture::Layer& layer : layers)
        for (const std::string& component : layer.components)
            names.push_back(layer.name.empty() ? component : layer.name + "." + component);
    return names;
}

std::vector<float> planes_of(std::span<const picture::Layer> layers) {
    std::vector<float> planes;
    for (const picture::Layer& layer : layers) {
        const std::uint32_t components = layer.image.components;
        for (std::uint32_t c = 0; c < components; ++c) {
            for (std::size_t i = 0; i < layer.image.pixel_count(); ++i) {
                const float value = layer.image.values[components * i + c];
                planes.push_back(layer.as_integers ? static_cast<float>(std::bit_cast<std::uint32_t>(value))
                                                   : value);
            }
        }
    }
    return planes;
}

// Of a part of all planes.
std::vector<float> cut(std::span<const float> planes, std::uint32_t width, std::uint32_t height,
                       const Rect& part) {
    std::vector<float> values;
    const std::size_t plane_size = std::size_t{width} * height;
    for (std::size_t first = 0; first < planes.size(); first += plane_size) {
        for (std::int32_t y = part.y; y < part.bottom(); ++y) {
            const auto row = planes.subspan(
                first + std::size_t{width} * static_cast<std::size_t>(y) + static_cast<std::size_t>(part.x),
                static_cast<std::size_t>(part.width));
            values.insert(values.end(), row.begin(), row.end());
        }
    }
    return values;
}

}  // namespace

Expected<void> check_address(const std::string& address) {
    const auto parsed = parse(address);
    if (!parsed) return tl::unexpected(parsed.error());
    return {};
}

Viewer::Viewer(const std::string& address, std::string image)
    : address_(address), image_(std::move(image)), socket_(connected_socket(address)) {}

Viewer::~Viewer() {
    if (socket_ >= 0) ::close(socket_);
}

bool Viewer::send(const Packet& packet) {
    std::size_t sent = 0;
    while (sent < packet.size()) {
        const ssize_t count = ::send(socket_, packet.data() + sent, packet.size() - sent, MSG_NOSIGNAL);
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) return false;
        sent += static_cast<std::size_t>(count);
    }
    return true;
}

std::optional<std::string> Viewer::show(std::span<const picture::Layer> layers) {
    if (socket_ < 0 || layers.empty()) return std::nullopt;
    const std::vector<std::string> channels = channel_names(layers);
    const std::uint32_t width = layers.front().image.width, height = layers.front().image.height;
    std::vector<float> planes = planes_of(layers);
    const auto lost = [&] {
        const std::string reason = std::generic_category().message(errno);
        ::close(std::exchange(socket_, -1));
        return "tev at " + address_ + " shows no more pictures: " + reason;
    };
    if (channels != channels_ || width != width_ || height != height_) {
        if (!send(create_image(image_, width, height, channels))) return lost();
        channels_ = channels;
        width_ = width;
        height_ = height;
        shown_.assign(planes.size(), 0.0f);
    }
    for (std::uint32_t y = 0; y < height; y += TileSize) {
        for (std::uint32_t x = 0; x < width; x += TileSize) {
            const Rect part{static_cast<std::int32_t>(x), static_cast<std::int32_t>(y),
                            static_cast<std::int32_t>(std::min(TileSize, width - x)),
                            static_cast<std::int32_t>(std::min(TileSize, height - y))};
            const std::vector<float> values = cut(planes, width, height, part);
            if (values == cut(shown_, width, height, part)) continue;
            if (!send(update_image(image_, channels_, part, values))) return lost();
        }
    }
    shown_ = std::move(planes);
    return std::nullopt;
}

}  // namespace tessera::tools::tev
