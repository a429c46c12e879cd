#include "client/display_file/zip_archive.h"

#include <zip.h>

#include <algorithm>
#include <string_view>

namespace tessera::display_file {

namespace {

bool leads_out(std::string_view name) {
    if (name.empty() || name.front() == '/' || name.find('\\') != std::string_view::npos ||
        name.find(':') != std::string_view::npos)
        return true;
    while (!name.empty()) {
        const std::string_view part = name.substr(0, name.find('/'));
        if (part == "..") return true;
        name.remove_prefix(std::min(part.size() + 1, name.size()));
    }
    return false;
}

}  // namespace

void ZipArchive::Closer::operator()(zip* archive) const {
    zip_discard(archive);
}

Expected<ZipArchive> ZipArchive::open(std::span<const std::byte> bytes, const std::string& name) {
    const auto refuse = [&](const std::string& why) {
        return failure(ErrorCode::InvalidInput, name + ": " + why);
    };
    zip_error_t error;
    zip_error_init(&error);
    zip_source_t* source = zip_source_buffer_create(bytes.data(), bytes.size(), 0, &error);
    std::unique_ptr<zip, Closer> archive(source != nullptr ? zip_open_from_source(source, ZIP_RDONLY, &error)
                                                           : nullptr);
    const std::string why = zip_error_strerror(&error);
    zip_error_fini(&error);
    if (!archive) {
        if (source != nullptr) zip_source_free(source);
        return refuse("is not a ZIP archive, or is damaged: " + why);
    }
    const auto count =
        static_cast<std::uint64_t>(std::max<zip_int64_t>(zip_get_num_entries(archive.get(), 0), 0));
    if (count > MostEntries)
        return refuse("has " + std::to_string(count) + " entries; " + std::to_string(MostEntries) +
                      " can be read");
    std::uint64_t total = 0;
    for (std::uint64_t i = 0; i < count; ++i) {
        zip_stat_t entry;
        if (zip_stat_index(archive.get(), i, 0, &entry) != 0 || (entry.valid & ZIP_STAT_NAME) == 0 ||
            (entry.valid & ZIP_STAT_SIZE) == 0)
            return refuse("entry " + std::to_string(i + 1) + " is damaged");
        if (leads_out(entry.name))
            return refuse(std::string("the entry '") + entry.name +
                          "' points outside of the archive: names must be relative, without '..'");
        if (entry.size > MostBytes || (total += entry.size) > MostBytes)
            return refuse("unpacks to more than " + std::to_string(MostBytes >> 30) + " GiB");
    }
    return ZipArchive(std::move(archive), name);
}

Expected<std::vector<std::byte>> ZipArchive::read(const std::string& entry) const {
    zip_int64_t index = zip_name_locate(archive_.get(), entry.c_str(), 0);
    if (index < 0) index = zip_name_locate(archive_.get(), entry.c_str(), ZIP_FL_NOCASE);
    if (index < 0)
        return failure(ErrorCode::NotFound,
                       name_ + ": '" + entry + "' is not in the archive: export it again");
    const auto refuse = [&](const std::string& why) {
        return failure(ErrorCode::InvalidInput,
                       name_ + ": '" + entry + "' cannot be unpacked (" + why + "): export it again");
    };
    zip_stat_t stat;
    if (zip_stat_index(archive_.get(), static_cast<zip_uint64_t>(index), 0, &stat) != 0)
        return refuse(zip_strerror(archive_.get()));
    const std::unique_ptr<zip_file_t, int (*)(zip_file_t*)> file(
        zip_fopen_index(archive_.get(), static_cast<zip_uint64_t>(index), 0), zip_fclose);
    if (!file) return refuse(zip_strerror(archive_.get()));
    // In pieces: the stated size is untrusted, memory grows with the actual data. Up to the end of the entry, since
    // only there libzip compares the checksum.
    constexpr std::size_t Piece = std::size_t{1} << 20;
    std::vector<std::byte> bytes;
    for (;;) {
        const std::size_t before = bytes.size();
        bytes.resize(before + std::min<std::size_t>(Piece, stat.size - before) + 1);
        const zip_int64_t got = zip_fread(file.get(), bytes.data() + before, bytes.size() - before);
        if (got < 0) return refuse(zip_file_strerror(file.get()));
        bytes.resize(before + static_cast<std::size_t>(got));
        if (bytes.size() > stat.size) return refuse("it is longer than the archive states");
        if (got == 0) break;
    }
    if (bytes.size() < stat.size) return refuse("it is shorter than the archive states");
    return bytes;
}

}  // namespace tessera::display_file
