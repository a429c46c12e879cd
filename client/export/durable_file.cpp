#include "client/export/durable_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <functional>
#include <string>

#include "mediator/base/error.h"
#include "mediator/picture/atomic_file.h"

namespace tessera::exporting {
namespace {

class Descriptor {
  public:
    explicit Descriptor(int number) : number_(number) {}
    ~Descriptor() {
        if (number_ >= 0) close(number_);
    }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    int number() const { return number_; }

  private:
    int number_;
};

Error failed(const std::filesystem::path& file) {
    return Error(ErrorCode::Io, "cannot write '" + file.string() + "': " + std::strerror(errno) +
                                    "; check the folder, its permissions and the free space");
}

void write_all(int file, std::span<const std::byte> bytes, const std::filesystem::path& name) {
    while (!bytes.empty()) {
        const ssize_t written = ::write(file, bytes.data(), bytes.size());
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) throw failed(name);
        bytes = bytes.subspan(static_cast<std::size_t>(written));
    }
}

}  // namespace

void write_durably(const std::filesystem::path& file, const std::function<void(const Sink&)>& write) {
    picture::write_atomically(file.string(), [&](const std::string& temporary) {
        const Descriptor opened(open(temporary.c_str(), O_WRONLY | O_TRUNC | O_CLOEXEC));
        if (opened.number() < 0) throw failed(file);
        write([&](std::span<const std::byte> bytes) { write_all(opened.number(), bytes, file); });
        if (fsync(opened.number()) != 0) throw failed(file);
    });
    // The rename is durable once the folder is flushed. File systems that cannot flush folders are ignored.
    const std::filesystem::path folder = file.has_parent_path() ? file.parent_path() : ".";
    const Descriptor opened(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (opened.number() >= 0) fsync(opened.number());
}

}  // namespace tessera::exporting
