#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "mediator/base/error.h"

struct zip;

namespace tessera::display_file {

// An untrusted ZIP archive in memory: its entry names are never used as file names on this machine, and the unpacked
// size is limited.
class ZipArchive {
  public:
    // `bytes` must outlive the archive. InvalidInput, beginning with `name`: not an archive, damaged, an entry
    // whose name points outside of it (.., absolute, a drive), or too many entries or bytes.
    static Expected<ZipArchive> open(std::span<const std::byte> bytes, const std::string& name);

    // A file by its name, ignoring case if there is no exact match. NotFound or InvalidInput.
    Expected<std::vector<std::byte>> read(const std::string& entry) const;

    static constexpr std::size_t MostEntries = 4096;
    static constexpr std::size_t MostBytes = std::size_t{2} << 30;  // of all files, unpacked

  private:
    struct Closer {
        void operator()(zip* archive) const;
    };
    ZipArchive(std::unique_ptr<zip, Closer> archive, std::string name)
        : archive_(std::move(archive)), name_(std::move(name)) {}

    std::unique_ptr<zip, Closer> archive_;
    std::string name_;
};

}  // namespace tessera::display_file
