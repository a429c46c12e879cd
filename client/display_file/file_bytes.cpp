#include "client/display_file/file_bytes.h"

#include <filesystem>
#include <fstream>

namespace tessera::display_file {

Expected<std::vector<std::byte>> read_file(const std::string& path, std::size_t most) {
    std::error_code code;
    const auto status = std::filesystem::status(path, code);
    if (!std::filesystem::exists(status))
        return failure(ErrorCode::NotFound, "'" + path + "' does not exist: check the name");
    if (!std::filesystem::is_regular_file(status))
        return failure(ErrorCode::InvalidInput, "'" + path + "' is not a file");
    const auto size = std::filesystem::file_size(path, code);
    if (code || size > most)
        return failure(ErrorCode::InvalidInput, "'" + path + "' has more than " + std::to_string(most) +
                                                    " bytes: it is not a calibration file");
    std::vector<std::byte> bytes(size);
    std::ifstream file(path, std::ios::binary);
    if (!file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size)))
        return failure(ErrorCode::Io, "cannot read '" + path + "': check its permissions");
    return bytes;
}

}  // namespace tessera::display_file
