#include "tests/fuzz/decoders/decoder.h"

#include <stdlib.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>

namespace tessera::fuzz {

namespace {

class PrivateFolder {
  public:
    PrivateFolder() : path_((std::filesystem::temp_directory_path() / "tessera-fuzz-XXXXXX").string()) {
        require(::mkdtemp(path_.data()) != nullptr, "no temporary folder can be made");
    }
    ~PrivateFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    PrivateFolder(const PrivateFolder&) = delete;
    PrivateFolder& operator=(const PrivateFolder&) = delete;
    std::filesystem::path path() const { return path_; }

  private:
    std::string path_;
};

}  // namespace

std::span<const Decoder> decoders() {
    static const std::vector<Decoder> all = [] {
        std::vector<Decoder> table;
        for (const auto& part : {message_decoders(), session_decoders(), scene_decoders(), picture_decoders(),
                                 display_decoders(), text_decoders()})
            table.insert(table.end(), part.begin(), part.end());
        return table;
    }();
    return all;
}

const Decoder* decoder_named(std::string_view name) {
    const auto found = std::ranges::find(decoders(), name, &Decoder::name);
    return found == decoders().end() ? nullptr : &*found;
}

void require(bool promise, const std::string& otherwise) {
    if (promise) return;
    std::fprintf(stderr, "broken promise: %s\n", otherwise.c_str());
    std::abort();
}

void require_reason(const Error& error) {
    require(error.what()[0] != '\0', "an error has no text");
    require(error.code() != ErrorCode::Internal, std::string("an error is a bug: ") + error.what());
}

bool accepts(const std::function<void()>& decode) {
    try {
        decode();
        return true;
    } catch (const Error& error) {
        require_reason(error);
        return false;
    }
}

std::string_view text_of(Bytes bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::vector<std::byte> bytes_of(std::string_view text) {
    const auto bytes = std::as_bytes(std::span(text));
    return {bytes.begin(), bytes.end()};
}

std::filesystem::path file_of(const std::string& name, Bytes bytes) {
    static const PrivateFolder folder;
    const std::filesystem::path path = folder.path() / name;
    std::ofstream out(path, std::ios::binary | std::ios::trunc);
    out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    out.close();
    require(out.good(), "a temporary file cannot be written");
    return path;
}

std::vector<std::byte> content_of(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    require(in.good() || in.eof(), "a file cannot be read: " + file.string());
    return bytes_of(text);
}

}  // namespace tessera::fuzz
