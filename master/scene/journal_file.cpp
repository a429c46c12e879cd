#include "master/scene/journal_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
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

}  // namespace

FileHandle::~FileHandle() {
    if (descriptor_ >= 0) ::close(descriptor_);
}

std::uint64_t size_of(const FileHandle& file) {
    struct stat status {};
    if (::fstat(file.descriptor(), &status) != 0)
        throw Error(ErrorCode::Io, std::string("cannot read it: ") + std::strerror(errno));
    return static_cast<std::uint64_t>(status.st_size);
}

bool read_at(const FileHandle& file, std::uint64_t offset, std::span<std::byte> bytes) {
    while (!bytes.empty()) {
        const ssize_t count =
            ::pread(file.descriptor(), bytes.data(), bytes.size(), static_cast<off_t>(offset));
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) throw Error(ErrorCode::Io, std::string("cannot read it: ") + std::strerror(errno));
        if (count == 0) return false;
        bytes = bytes.subspan(static_cast<std::size_t>(count));
        offset += static_cast<std::uint64_t>(count);
    }
    return true;
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

// Reads a segment record by record: one is in memory at a time.
class SegmentReader {
  public:
    explicit SegmentReader(const std::filesystem::path& path)
        : file_(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
        if (file_.descriptor() < 0) throw cannot("read", path);
        byte_size_ = size_of(file_);
    }
    std::uint64_t byte_size() const { return byte_size_; }

    // Fewer if the file ends before.
    std::vector<std::byte> start(std::size_t count) const {
        std::vector<std::byte> bytes(std::min<std::uint64_t>(count, byte_size_));
        if (!read_at(file_, 0, bytes)) bytes.clear();
        return bytes;
    }

    struct Record {
        std::uint32_t stored_length = 0;
        std::vector<std::byte> checksum;
        std::optional<std::vector<std::byte>> payload;  // nothing: it is incomplete or damaged
        bool is_repaired = false;
    };
    // The record that begins at the offset; its head is complete. A length with one wrong bit would cost this record
    // and all after it: the checksum says which bit it is.
    Record record(std::uint64_t offset, const std::vector<std::byte>& chain) const {
        std::array<std::byte, RecordHead> head{};
        Record record;
        if (!read_at(file_, offset, head)) return record;
        std::memcpy(&record.stored_length, head.data(), sizeof record.stored_length);
        record.checksum.assign(head.begin() + LengthBytes, head.end());
        const std::uint64_t content = offset + RecordHead;
        if (matches(record, content, record.stored_length, chain)) {
            record.payload = payload(content, record.stored_length);
            return record;
        }
        for (std::uint32_t bit = 1; bit != 0; bit <<= 1) {
            if (!matches(record, content, record.stored_length ^ bit, chain)) continue;
            record.payload = payload(content, record.stored_length ^ bit);
            record.is_repaired = true;
            return record;
        }
        return record;
    }

  private:
    bool matches(const Record& record, std::uint64_t content, std::uint32_t length,
                 const std::vector<std::byte>& chain) const {
        if (length == 0 || byte_size_ - content < length) return false;
        constexpr std::uint64_t MostRead = std::uint64_t{1} << 18;
        Blake2b hash;
        hash.update(chain);
        std::vector<std::byte> piece;
        for (std::uint64_t done = 0; done < length; done += piece.size()) {
            piece.resize(std::min(PieceBytes, length - done));
            if (!read_at(file_, content + done, piece)) return false;
            hash.update(piece);
        }
        const Hash256 full = hash.finish();
        return std::ranges::equal(record.checksum, std::as_bytes(std::span(full.bytes)).first(ChecksumBytes));
    }
    std::optional<std::vector<std::byte>> payload(std::uint64_t content, std::uint32_t length) const {
        std::vector<std::byte> bytes(length);
        if (!read_at(file_, content, bytes)) return std::nullopt;
        return bytes;
    }

    FileHandle file_;
    std::uint64_t byte_size_ = 0;
};

}  // namespace

JournalScan read_journal(const std::filesystem::path& path, std::uint64_t number,
                         const std::function<Expected<void>(std::span<const std::byte>)>& take) {
    const SegmentReader file(path);
    JournalScan scan{.byte_size = file.byte_size()};
    const auto stop = [&](JournalEnd end, const std::string& cause) {
        scan.end = end;
        scan.text = "'" + path.string() + "' at byte " + std::to_string(scan.offset) + ": " + cause;
        return scan;
    };
    const std::vector<std::byte> head = header(number), start = file.start(HeaderBytes);
    if (start.size() < HeaderBytes) {
        const bool begun = std::equal(start.begin(), start.end(), head.begin());
        return stop(begun ? JournalEnd::Torn : JournalEnd::Damaged, "its header is incomplete");
    }
    if (start != head) return stop(JournalEnd::Damaged, "its header belongs to another segment");
    std::vector<std::byte> chain = checksum({}, head);
    scan.offset = HeaderBytes;
    while (scan.offset < file.byte_size()) {
        const std::uint64_t rest = file.byte_size() - scan.offset;
        if (rest < RecordHead) return stop(JournalEnd::Torn, "the last record is incomplete");
        SegmentReader::Record record = file.record(scan.offset, chain);
        if (!record.payload) {
            if (record.stored_length == 0) return stop(JournalEnd::Damaged, "a record without content");
            const std::uint64_t bytes = rest - RecordHead;
            if (bytes < record.stored_length)
                return stop(JournalEnd::Torn, "the last record is incomplete, or its length is damaged");
            return stop(bytes == record.stored_length ? JournalEnd::Torn : JournalEnd::Damaged,
                        "a record's checksum does not match");
        }
        scan.repaired += record.is_repaired ? 1 : 0;
        if (auto taken = take(*record.payload); !taken)
            return stop(JournalEnd::Damaged, taken.error().what());
        chain = std::move(record.checksum);
        scan.offset += RecordHead + record.payload->size();
        ++scan.records;
    }
    return scan;
}

}  // namespace tessera::master
