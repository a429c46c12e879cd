#include "mediator/picture/exr_header.h"

#include <array>
#include <cstring>
#include <fstream>
#include <optional>

#include "mediator/base/error.h"

namespace tessera::picture {

namespace {

Error damaged(const std::string& reason) {
    return Error(ErrorCode::InvalidInput, reason + ": write it again");
}

// Little-endian; so are all supported hosts.
class Reader {
  public:
    explicit Reader(const std::string& path) : file_(path, std::ios::binary) {
        file_.seekg(0, std::ios::end);
        size_ = static_cast<std::int64_t>(file_.tellg());
        file_.seekg(0);
        if (!file_ || size_ < 0) throw Error(ErrorCode::Io, "it cannot be opened: check its rights");
    }
    template <class T>
    T value() {
        T result{};
        file_.read(reinterpret_cast<char*>(&result), sizeof result);
        require_good();
        return result;
    }
    std::string text() {
        constexpr std::size_t LongestName = 255;
        std::string result;
        for (char letter = value<char>(); letter != '\0'; letter = value<char>()) {
            if (result.size() == LongestName) throw damaged("its header has an unterminated name");
            result += letter;
        }
        return result;
    }
    void skip(std::int64_t bytes) {
        if (bytes < 0 || bytes > size_ - static_cast<std::int64_t>(file_.tellg()))
            throw damaged("its header has an attribute that is larger than the file");
        file_.seekg(bytes, std::ios::cur);
    }

  private:
    void require_good() {
        if (!file_) throw damaged("it ends in the middle of its header");
    }
    std::ifstream file_;
    std::int64_t size_ = 0;
};

Rect checked_window(const std::array<std::int32_t, 4>& box) {
    const auto [left, top, right, bottom] = box;
    const std::int64_t width = std::int64_t{right} - left + 1, height = std::int64_t{bottom} - top + 1;
    constexpr std::int64_t MaxCoordinate = std::int64_t{1} << 30;
    if (width < 1 || height < 1 || std::abs(std::int64_t{left}) > MaxCoordinate ||
        std::abs(std::int64_t{top}) > MaxCoordinate) {
        throw damaged("its data window is empty or out of range");
    }
    if (width > MaxPicturePixels || height > MaxPicturePixels || width * height > MaxPicturePixels) {
        throw Error(ErrorCode::InvalidInput, "it claims " + std::to_string(width) + " x " +
                                                 std::to_string(height) + " pixels, more than the " +
                                                 std::to_string(MaxPicturePixels) +
                                                 " that are supported: scale it down");
    }
    return {left, top, static_cast<std::int32_t>(width), static_cast<std::int32_t>(height)};
}

void check_version(Reader& reader) {
    constexpr std::uint32_t Magic = 20000630, NumberMask = 0xff, Deep = 0x800, SeveralParts = 0x1000;
    if (reader.value<std::uint32_t>() != Magic) throw damaged("it is not an OpenEXR file");
    const auto version = reader.value<std::uint32_t>();
    if ((version & NumberMask) != 2) throw damaged("its version of OpenEXR is not 2");
    if (version & (Deep | SeveralParts)) {
        throw Error(ErrorCode::InvalidInput, "it has deep pixels or several parts: save it as one flat part");
    }
}

}  // namespace

Rect checked_exr_window(const std::string& path) {
    Reader reader(path);
    check_version(reader);
    std::optional<Rect> window;
    for (std::string name = reader.text(); !name.empty(); name = reader.text()) {
        reader.text();  // its type
        const auto size = reader.value<std::int32_t>();
        if (name == "dataWindow" && size == sizeof(std::array<std::int32_t, 4>)) {
            window = checked_window(reader.value<std::array<std::int32_t, 4>>());
        } else if (name == "tiles" && size >= 8) {
            const auto tile = reader.value<std::array<std::uint32_t, 2>>();
            if (tile[0] > MaxPicturePixels || tile[1] > MaxPicturePixels ||
                std::int64_t{tile[0]} * tile[1] > MaxPicturePixels) {
                throw damaged("its tiles are too large");
            }
            reader.skip(size - 8);
        } else {
            reader.skip(size);
        }
    }
    if (!window) throw damaged("its header has no data window");
    return *window;
}

}  // namespace tessera::picture
