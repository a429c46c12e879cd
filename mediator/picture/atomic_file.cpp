#include "mediator/picture/atomic_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <functional>

#include "mediator/base/error.h"

namespace tessera::picture {

namespace {

Error cannot_write(const std::string& path) {
    return Error(ErrorCode::Io, "cannot write '" + path + "': " + std::strerror(errno) +
                                    "; check the folder, its rights and the free space");
}

}  // namespace

void write_atomically(const std::string& path, const std::function<void(const std::string&)>& write) {
    const std::string temporary = path + ".part-" + std::to_string(getpid());
    // Opened first, so that the error message is that of the system.
    const int file = open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (file < 0) throw cannot_write(path);
    close(file);
    try {
        write(temporary);
    } catch (...) {
        unlink(temporary.c_str());
        throw;
    }
    if (std::rename(temporary.c_str(), path.c_str()) != 0) {
        const Error error = cannot_write(path);
        unlink(temporary.c_str());
        throw error;
    }
}

void write_atomically(const std::string& path, std::string_view content) {
    write_atomically(path, [&](const std::string& temporary) {
        std::ofstream file(temporary, std::ios::binary);
        file.write(content.data(), static_cast<std::streamsize>(content.size()));
        file.close();
        if (!file) throw Error(ErrorCode::Io, "cannot write '" + path + "': is the disk full?");
    });
}

}  // namespace tessera::picture
