#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "mediator/base/error.h"

namespace tessera::master {

// A file of the operating system, closed with its last owner.
class FileHandle {
  public:
    explicit FileHandle(int descriptor) : descriptor_(descriptor) {}
    ~FileHandle();
    FileHandle(const FileHandle&) = delete;
    FileHandle& operator=(const FileHandle&) = delete;
    int descriptor() const { return descriptor_; }

  private:
    int descriptor_;
};
using FilePtr = std::shared_ptr<const FileHandle>;

// One segment of a journal. A header (magic, format, number), then records: length in bytes (32 bits,
// little-endian), BLAKE2b-128 over the checksum before it and the payload, the payload. So no record can be
// changed, left out or put elsewhere unnoticed. Appended by one thread only.
class JournalFile {
  public:
    // A new segment; throws Error{Io} when it cannot be made, also when there is one of that number.
    JournalFile(const std::filesystem::path& path, std::uint64_t number);

    // Back after write(2) took the whole record: the death of the process loses nothing. On failure the file
    // is cut back to what it was; where even that fails, every later append fails, too.
    Expected<void> append(std::span<const std::byte> payload);

    std::uint64_t byte_size() const { return byte_size_; }
    FilePtr file() const { return file_; }

  private:
    Expected<void> write(std::span<const std::byte> bytes);

    std::filesystem::path path_;
    FilePtr file_;
    std::uint64_t byte_size_ = 0;
    std::vector<std::byte> chain_;  // the last checksum
    bool broken_ = false;
};

enum class JournalEnd {
    Complete,  // after a whole record
    Torn,      // in the middle of the last record: what was being written when its master died
    Damaged,   // at a record that is not what was written, though more follows, or at the header
};

struct JournalScan {
    std::uint64_t records = 0;
    JournalEnd end = JournalEnd::Complete;
    std::uint64_t offset = 0;  // of what is no record any more: so many bytes are good
    std::uint64_t byte_size = 0;
    std::string text;  // where and what, when it is not complete
};

// Hands every good record to `take` in order, until that says no (then it ends there as damaged, with the
// reason) or the file does. Reads what is there, also while a master appends. Throws Error{Io} when it cannot
// be read at all.
JournalScan read_journal(const std::filesystem::path& path, std::uint64_t number,
                         const std::function<Expected<void>(std::span<const std::byte>)>& take);

}  // namespace tessera::master
