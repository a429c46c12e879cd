#include "mediator/net/secret_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>

#include "mediator/base/error.h"

namespace tessera::net {

namespace {

[[noreturn]] void fail(const std::string& what, const std::filesystem::path& path) {
    throw Error(ErrorCode::Io, "cannot " + what + " '" + path.string() + "': " + std::strerror(errno));
}

}  // namespace

void write_text(const std::filesystem::path& path, const std::string& text, Visibility visibility) {
    const std::filesystem::path temporary = path.string() + ".new";
    unlink(temporary.c_str());
    const mode_t mode = visibility == Visibility::Owner ? 0600 : 0644;
    const int file = open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
    if (file < 0) fail("write", temporary);
    const bool written = write(file, text.data(), text.size()) == static_cast<ssize_t>(text.size()) &&
                         fchmod(file, mode) == 0 && fsync(file) == 0;
    const bool closed = close(file) == 0;
    if (!written || !closed || rename(temporary.c_str(), path.c_str()) != 0) {
        const int why = errno;
        unlink(temporary.c_str());
        errno = why;
        fail("write", path);
    }
}

std::string read_text(const std::filesystem::path& path) {
    constexpr std::uintmax_t Limit = 1 << 20;
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(path, error);
    if (error) {
        throw Error(ErrorCode::NotFound, "cannot read '" + path.string() + "': " + error.message() +
                                             "; make keys with 'tessera keys DIR'");
    }
    if (size > Limit)
        throw Error(ErrorCode::InvalidInput, "'" + path.string() + "' is too large to hold keys");
    std::ifstream file(path);
    if (!file) fail("read", path);
    return {std::istreambuf_iterator<char>(file), {}};
}

void require_unwritable(const std::filesystem::path& path) {
    struct stat status {};
    if (stat(path.c_str(), &status) == 0 && (status.st_mode & 022) != 0) {
        throw Error(ErrorCode::Refused,
                    "'" + path.string() + "' may be changed by others: chmod go-w '" + path.string() + "'");
    }
    const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
    if (stat(folder.c_str(), &status) == 0 && (status.st_mode & 002) != 0) {
        throw Error(ErrorCode::Refused,
                    "'" + path.string() + "' may be replaced by others: chmod o-w '" + folder.string() + "'");
    }
}

void require_private(const std::filesystem::path& path) {
    struct stat status {};
    if (stat(path.c_str(), &status) != 0) {
        throw Error(ErrorCode::NotFound,
                    "no secret key '" + path.string() + "': make keys with 'tessera keys DIR'");
    }
    if ((status.st_mode & 077) != 0) {
        throw Error(ErrorCode::Refused, "the secret key '" + path.string() +
                                            "' is open to others: chmod 600 '" + path.string() + "'");
    }
}

}  // namespace tessera::net
