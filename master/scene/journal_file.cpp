#include "master/scene/journal_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <functional>
#include <optional>

#include "mediator/base/hash.h"

namespace tessera::master {

namespace {

constexpr std::array<char, 8> JournalMagic{'T', 'S', 'J', 'O', 'U', 'R', 'N', '1'};
constexpr std::size_t HeaderBytes = 16, LengthBytes = 4, ChecksumBytes = 16;
constexpr std::size_t RecordHead = LengthBytes + ChecksumBytes;

Error cannot(const char* what, const std::filesystem::path& path) {
    return Error(ErrorCode::Io, std::string("cannot ") + what + " '" + path.string() +
                                    "': " + std::strerror(errno) +
                                    "; check the folder, its rights and the free space");
}

template <class T>
void put(std::vector<std::byte>& bytes, const T& value) {
    const auto raw = std::as_bytes(std::span(&value, 1));
    bytes.insert(bytes.end(), raw.begin(), raw.end());
}

std::vector<std::byte> header(std::uint64_t number) {
    std::vector<std::byte> bytes;
    put(bytes, JournalMagic);
    put(bytes, number);
    return bytes;
}

std::vector<std::byte> checksum(std::span<const std::byte> chain, std::span<const std::byte> payload) {
    Blake2b hash;
    hash.update(chain);
    hash.update(payload);
    const Hash256 full = hash.finish();
    return {full.bytes.begin(), full.bytes.begin() + ChecksumBytes};
}

std::vector<std::byte> journal_bytes(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary | std::ios::ate);
    if (!file) throw cannot("read", path);
    std::vector<std::byte> bytes(static_cast<std::size_t>(file.tellg()));
    file.seekg(0);
    file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    bytes.resize(static_cast<std::size_t>(file.gcount()));
    return bytes;
}

}  // namespace

FileHandle::~FileHandle() {
    if (descriptor_ >= 0) ::close(descriptor_);
}

JournalFile::JournalFile(const std::filesystem::path& path, std::uint64_t number)
    : path_(path),
      file_(std::make_shared<FileHandle>(
          ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC, 0600))) {
    if (file_->descriptor() < 0) throw cannot("make", path);
    const std::vector<std::byte> head = header(number);
    if (auto written = write(head); !written) {
        ::unlink(path.c_str());
        throw written.error();
    }
    byte_size_ = head.size();
    chain_ = checksum({}, head);
}

Expected<void> JournalFile::write(std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
        const ssize_t count = ::write(file_->descriptor(), bytes.data(), bytes.size());
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) return tl::unexpected(cannot("write", path_));
        bytes = bytes.subspan(static_cast<std::size_t>(count));
    }
    return {};
}

Expected<void> JournalFile::append(std::span<const std::byte> payload) {
    if (broken_) {
        return failure(ErrorCode::Io, "the journal '" + path_.string() +
                                          "' could not be written before: start the master again");
    }
    if (payload.size() > 0xffffffffu || payload.empty())
        return failure(ErrorCode::InvalidInput,
                       "an edit of more than 4 GiB cannot be recorded: make it in parts");
    std::vector<std::byte> sum = checksum(chain_, payload);
    std::vector<std::byte> record;
    record.reserve(RecordHead + payload.size());
    put(record, static_cast<std::uint32_t>(payload.size()));
    record.insert(record.end(), sum.begin(), sum.end());
    record.insert(record.end(), payload.begin(), payload.end());
    if (auto written = write(record); !written) {
        broken_ = ::ftruncate(file_->descriptor(), static_cast<off_t>(byte_size_)) != 0;
        return written;
    }
    byte_size_ += record.size();
    chain_ = std::move(sum);
    return {};
}

namespace {

// The length of the record that `rest` begins with; nothing: it is incomplete or damaged. A length with one wrong bit
// would cost this record and all after it: the checksum says which bit it is.
struct RecordLength {
    std::optional<std::uint32_t> length;
    bool is_repaired = false;
};
RecordLength length_of(std::span<const std::byte> rest, const std::vector<std::byte>& chain) {
    std::uint32_t stored = 0;
    std::memcpy(&stored, rest.data(), sizeof stored);
    const auto matches = [&](std::uint32_t length) {
        if (length == 0 || rest.size() - RecordHead < length) return false;
        const std::vector<std::byte> sum = checksum(chain, rest.subspan(RecordHead, length));
        return std::equal(sum.begin(), sum.end(), rest.begin() + LengthBytes);
    };
    if (matches(stored)) return {stored, false};
    for (std::uint32_t bit = 1; bit != 0; bit <<= 1) {
        if (matches(stored ^ bit)) return {stored ^ bit, true};
    }
    return {};
}

}  // namespace

JournalScan read_journal(const std::filesystem::path& path, std::uint64_t number,
                         const std::function<Expected<void>(std::span<const std::byte>)>& take) {
    const std::vector<std::byte> file = journal_bytes(path);
    JournalScan scan{.byte_size = file.size()};
    const auto stop = [&](JournalEnd end, const std::string& cause) {
        scan.end = end;
        scan.text = "'" + path.string() + "' at byte " + std::to_string(scan.offset) + ": " + cause;
        return scan;
    };
    const std::vector<std::byte> head = header(number);
    const std::span<const std::byte> all(file);
    if (file.size() < HeaderBytes) {
        const bool begun = std::equal(file.begin(), file.end(), head.begin());
        return stop(begun ? JournalEnd::Torn : JournalEnd::Damaged, "its header is incomplete");
    }
    if (!std::equal(head.begin(), head.end(), file.begin()))
        return stop(JournalEnd::Damaged, "its header belongs to another segment");
    std::vector<std::byte> chain = checksum({}, head);
    scan.offset = HeaderBytes;
    while (scan.offset < file.size()) {
        const std::span<const std::byte> rest = all.subspan(scan.offset);
        if (rest.size() < RecordHead) return stop(JournalEnd::Torn, "the last record is incomplete");
        const RecordLength found = length_of(rest, chain);
        if (!found.length) {
            std::uint32_t stored = 0;
            std::memcpy(&stored, rest.data(), sizeof stored);
            if (stored == 0) return stop(JournalEnd::Damaged, "a record without content");
            const std::size_t bytes = rest.size() - RecordHead;
            if (bytes < stored)
                return stop(JournalEnd::Torn, "the last record is incomplete, or its length is damaged");
            return stop(bytes == stored ? JournalEnd::Torn : JournalEnd::Damaged,
                        "a record's checksum does not match");
        }
        scan.repaired += found.is_repaired ? 1 : 0;
        const std::uint32_t length = *found.length;
        const auto payload = rest.subspan(RecordHead, length);
        if (auto taken = take(payload); !taken) return stop(JournalEnd::Damaged, taken.error().what());
        chain.assign(rest.begin() + LengthBytes, rest.begin() + RecordHead);
        scan.offset += RecordHead + length;
        ++scan.records;
    }
    return scan;
}

}  // namespace tessera::master
