#pragma once

#include <zip.h>

#include <bit>
#include <cstring>
#include <map>
#include <string>
#include <vector>

// Archives of MPCDI for tests.
namespace tessera::display_file::test {

inline std::string pfm(std::uint32_t columns, std::uint32_t rows, const std::vector<float>& values) {
    std::string bytes = "PF\n" + std::to_string(columns) + " " + std::to_string(rows) + "\n-1.0\n";
    const std::size_t header = bytes.size();
    bytes.resize(header + 4 * values.size());
    std::memcpy(bytes.data() + header, values.data(), 4 * values.size());
    return bytes;
}

using Entries = std::vector<std::pair<std::string, std::string>>;

inline std::vector<std::byte> zipped(const Entries& entries, int compression = ZIP_CM_DEFAULT) {
    zip_error_t error;
    zip_error_init(&error);
    zip_source_t* target = zip_source_buffer_create(nullptr, 0, 0, &error);
    zip_source_keep(target);
    zip_t* archive = zip_open_from_source(target, ZIP_TRUNCATE, &error);
    for (const auto& [name, content] : entries) {
        const zip_int64_t index = zip_file_add(
            archive, name.c_str(), zip_source_buffer(archive, content.data(), content.size(), 0), 0);
        zip_set_file_compression(archive, static_cast<zip_uint64_t>(index), compression, 0);
    }
    zip_close(archive);
    zip_source_open(target);
    zip_source_seek(target, 0, SEEK_END);
    std::vector<std::byte> bytes(static_cast<std::size_t>(zip_source_tell(target)));
    zip_source_seek(target, 0, SEEK_SET);
    zip_source_read(target, bytes.data(), bytes.size());
    zip_source_close(target);
    zip_source_free(target);
    zip_error_fini(&error);
    return bytes;
}

inline std::string xml(const std::string& profile, const std::string& regions, const std::string& files) {
    return "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<MPCDI profile=\"" + profile +
           "\" geometry=\"1\" color=\"1\" version=\"2.0\">\n<display>\n"
           "<buffer id=\"buffer 1\" Xresolution=\"3000\" Yresolution=\"1000\">\n" +
           regions + "</buffer>\n</display>\n<files>\n" + files + "</files>\n</MPCDI>\n";
}

inline std::string region(const std::string& id, const std::string& inside = "",
                          const std::string& place = "x=\"0\" y=\"0\" xsize=\"1\" ysize=\"1\"") {
    return "<region id=\"" + id + "\" Xresolution=\"40\" Yresolution=\"30\" " + place + ">" + inside +
           "</region>\n";
}

inline std::string files(const std::string& id, const std::string& inside) {
    return "<fileset region=\"" + id + "\">\n" + inside + "</fileset>\n";
}

}  // namespace tessera::display_file::test
