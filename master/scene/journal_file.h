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

// A file descriptor, closed with its last owner.
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

std::uint64_t size_of(const FileHandle& file);  // bytes; throws Error{Io}
// Fills `bytes` from that offset on; false: the file ends before. Throws Error{Io}.
bool read_at(const FileHandle& file, std::uint64_t offset, std::span<std::byte> bytes);

// One segment of a journal. A header (magic, format, number), then records: length in bytes (32 bits,
// little-endian), BLAKE2b-128 over the checksum before it and the payload, the payload. So no record can be
// changed, left out or put elsewhere unnoticed. Appended by one thread only.
class JournalFile {
  public:
    // Creates a segment; throws Error{Io} if it cannot be created or exists already.
    JournalFile(const std::filesystem::path& path, std::uint64_t number);

    // Returns after write(2) has taken the whole record, so a crash of the process loses nothing. On failure the
    // file is truncated to its previous length; if that fails too, every later append fails.
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
    Torn,      // in the middle of the last record: the master crashed while writing it
    Damaged,   // at a corrupt record that others follow, or at the header
};

struct JournalScan {
    std::uint64_t records = 0;
    JournalEnd end = JournalEnd::Complete;
    std::uint64_t offset = 0;  // of the first invalid byte: all before it are valid
    std::uint64_t byte_size = 0;
    std::string text;            // where and why, unless complete
    std::uint64_t repaired = 0;  // records with one wrong bit in their length
};

// Passes every valid record to `take` in order, until `take` fails (the scan then ends there as damaged, with its
// reason) or the file ends. May run while a master appends. Throws Error{Io} if the file cannot be read.
JournalScan read_journal(const std::filesystem::path& path, std::uint64_t number,
                         const std::function<Expected<void>(std::span<const std::byte>)>& take);

}  // namespace tessera::master
