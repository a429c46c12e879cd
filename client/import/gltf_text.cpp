#include "client/import/gltf_text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <limits>

#include "client/import/gltf_material_check.h"
#include "client/import/limits.h"

namespace tessera::import {
namespace {

struct TextRange {
    std::size_t begin = 0, end = 0;
    bool empty() const { return begin == end; }
};

// Replaces `length` bytes from `position` on.
struct Edit {
    std::size_t position = 0;
    std::string insertion;
    std::size_t length = 0;
};

// The edits to apply, by position. Edits within the materials only turn invalid JSON into valid JSON.
struct Scan {
    std::vector<Edit> edits;
    TextRange materials;  // the top-level array including brackets
};

// One open array or object.
struct Level {
    bool is_object = false;
    TextRange key;                   // the last string; a key if a colon follows
    bool has_key = false;            // a value for `key` is expected
    TextRange indices_key, indices;  // "indices": <number>
    std::size_t attributes = 0;      // just after the brace of "attributes": {
};

constexpr bool is_space(char c) {
    return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}
constexpr bool is_letter(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}
constexpr bool is_number(char c) {
    return (c >= '0' && c <= '9') || c == '-' || c == '+' || c == '.' || c == 'e' || c == 'E';
}

class Scanner {
  public:
    explicit Scanner(std::string_view json) : json_(json) {}

    Expected<Scan> run() {
        while (at_ < json_.size()) {
            const char c = json_[at_];
            if (c == '"') {
                string();
            } else if (c == '{' || c == '[') {
                if (levels_.size() >= MaxTextNesting) {
                    return failure(ErrorCode::InvalidInput, "its JSON is nested more than " +
                                                                std::to_string(MaxTextNesting) +
                                                                " deep: export the scene again");
                }
                open(c == '{');
            } else if (c == '}' || c == ']') {
                close();
            } else if (in_materials() && (is_number(c) || is_letter(c))) {
                word();
            } else if (is_number(c)) {
                number();
            } else {
                if (!levels_.empty() && c == ':') levels_.back().has_key = true;
                if (!levels_.empty() && c == ',') levels_.back().has_key = false;
                ++at_;
            }
        }
        std::stable_sort(scan_.edits.begin(), scan_.edits.end(),
                         [](const Edit& a, const Edit& b) { return a.position < b.position; });
        return std::move(scan_);
    }

  private:
    bool in_materials() const { return materials_level_ != 0; }
    std::string_view text(TextRange range) const {
        return json_.substr(range.begin, range.end - range.begin);
    }

    void string() {
        const std::size_t begin = ++at_;
        while (at_ < json_.size() && json_[at_] != '"') at_ += json_[at_] == '\\' ? 2 : 1;
        at_ = std::min(at_, json_.size());
        if (!levels_.empty() && !levels_.back().has_key) levels_.back().key = {begin, at_};
        ++at_;
    }

    void open(bool is_object) {
        ++at_;
        if (is_object && !levels_.empty() && levels_.back().has_key &&
            text(levels_.back().key) == "attributes") {
            levels_.back().attributes = at_;
        }
        if (!is_object && levels_.size() == 1 && levels_[0].has_key && text(levels_[0].key) == "materials") {
            scan_.materials.begin = at_ - 1;
            materials_level_ = levels_.size() + 1;
        }
        levels_.emplace_back();
        levels_.back().is_object = is_object;
    }

    void close() {
        ++at_;
        if (levels_.empty()) return;
        const Level level = levels_.back();
        if (levels_.size() == materials_level_) {
            scan_.materials.end = at_;
            materials_level_ = 0;
        }
        levels_.pop_back();
        if (in_materials()) return;
        if (!level.is_object || level.indices.empty() || level.attributes == 0) return;
        std::size_t next = level.attributes;
        while (next < json_.size() && is_space(json_[next])) ++next;
        const bool alone = next < json_.size() && json_[next] == '}';
        scan_.edits.push_back({level.indices_key.begin, "_"});
        scan_.edits.push_back({level.attributes, '"' + std::string(IndicesAttribute) + "\":" +
                                                     std::string(text(level.indices)) + (alone ? "" : ",")});
    }

    void number() {
        const std::size_t begin = at_;
        while (at_ < json_.size() && is_number(json_[at_])) ++at_;
        if (levels_.empty() || !levels_.back().has_key || text(levels_.back().key) != "indices") return;
        levels_.back().indices_key = levels_.back().key;
        levels_.back().indices = {begin, at_};
    }

    // A number or word in a material: if invalid or not finite, it becomes a string, which the check rejects.
    void word() {
        const std::size_t begin = at_;
        while (at_ < json_.size() && (is_number(json_[at_]) || is_letter(json_[at_]))) ++at_;
        const std::string_view word = json_.substr(begin, at_ - begin);
        double value = 0.0;
        const auto [last, error] = std::from_chars(word.data(), word.data() + word.size(), value);
        const bool is_number =
            error == std::errc{} && last == word.data() + word.size() && std::isfinite(value);
        if (!is_number && word != "true" && word != "false" && word != "null")
            scan_.edits.push_back({begin, '"' + std::string(word) + '"', word.size()});
    }

    std::string_view json_;
    std::size_t at_ = 0;
    std::vector<Level> levels_;
    std::size_t materials_level_ = 0;  // nesting level of the materials array while it is open, from 1
    Scan scan_;
};

std::string applied(std::string_view text, std::size_t first, const std::vector<Edit>& edits) {
    std::string result;
    result.reserve(text.size() + edits.size() * 24);
    std::size_t done = 0;
    for (const Edit& edit : edits) {
        const std::size_t position = edit.position - first;
        result.append(text.substr(done, position - done));
        result.append(edit.insertion);
        done = position + edit.length;
    }
    result.append(text.substr(done));
    return result;
}

// Removes invalid values from the materials, by a single edit.
std::vector<std::string> check_materials(std::string_view json, Scan& scan) {
    const auto [begin, end] = scan.materials;
    if (end <= begin) return {};
    const auto is_in_materials = [&](const Edit& edit) {
        return edit.position >= begin && edit.position < end;
    };
    std::vector<Edit> quotes;
    std::copy_if(scan.edits.begin(), scan.edits.end(), std::back_inserter(quotes), is_in_materials);
    CheckedMaterials checked = check_gltf_materials(applied(json.substr(begin, end - begin), begin, quotes));
    std::erase_if(scan.edits, is_in_materials);
    if (checked.json.empty()) return std::move(checked.notices);
    const auto next = std::find_if(scan.edits.begin(), scan.edits.end(),
                                   [&](const Edit& edit) { return edit.position >= end; });
    scan.edits.insert(next, {begin, std::move(checked.json), end - begin});
    return std::move(checked.notices);
}

std::uint32_t read_u32(std::span<const unsigned char> bytes, std::size_t offset) {
    std::uint32_t value = 0;
    std::memcpy(&value, bytes.data() + offset, sizeof value);
    return value;
}

void append_u32(std::string& to, std::size_t value) {
    const auto narrow = static_cast<std::uint32_t>(value);
    to.append(reinterpret_cast<const char*>(&narrow), sizeof narrow);
}

tl::unexpected<Error> damaged(const std::string& what) {
    return failure(ErrorCode::InvalidInput, what + ": it is damaged or was cut off; copy or export it again");
}

}  // namespace

Expected<PreparedText> prepare_gltf_text(std::string_view json) {
    Expected<Scan> scan = Scanner(json).run();
    if (!scan) return tl::unexpected<Error>(scan.error());
    PreparedText prepared;
    prepared.notices = check_materials(json, *scan);
    prepared.text = applied(json, 0, scan->edits);
    return prepared;
}

bool is_glb(std::span<const unsigned char> bytes) {
    return bytes.size() >= 4 && std::memcmp(bytes.data(), "glTF", 4) == 0;
}

Expected<PreparedText> prepare_glb(std::span<const unsigned char> bytes) {
    constexpr std::size_t Header = 12, ChunkHeader = 8;
    constexpr std::uint32_t Json = 0x4e4f534a;
    if (bytes.size() < Header + ChunkHeader) return damaged("the GLB ends inside its header");
    const std::uint32_t version = read_u32(bytes, 4);
    if (version != 2) {
        return failure(ErrorCode::InvalidInput,
                       "it is a GLB of version " + std::to_string(version) + ": convert it to glTF 2.0");
    }
    const std::size_t length = read_u32(bytes, 8);
    if (length > bytes.size()) {
        return damaged("the GLB says that it has " + std::to_string(length) + " bytes, the file has " +
                       std::to_string(bytes.size()));
    }
    const std::size_t json_length = read_u32(bytes, 12);
    if (length < Header + ChunkHeader || read_u32(bytes, 16) != Json ||
        json_length > length - Header - ChunkHeader) {
        return damaged("the GLB has no complete JSON chunk");
    }
    const auto* text = reinterpret_cast<const char*>(bytes.data() + Header + ChunkHeader);
    Expected<PreparedText> prepared = prepare_gltf_text({text, json_length});
    if (!prepared) return prepared;
    std::string& json = prepared->text;
    json.resize((json.size() + 3) / 4 * 4, ' ');
    const auto rest =
        bytes.subspan(Header + ChunkHeader + json_length, length - Header - ChunkHeader - json_length);
    const std::size_t total = Header + ChunkHeader + json.size() + rest.size();
    if (total > std::numeric_limits<std::uint32_t>::max()) {
        return failure(ErrorCode::InvalidInput, "the GLB is larger than 4 GiB: split it");
    }
    std::string glb = "glTF";
    append_u32(glb, 2);
    append_u32(glb, total);
    append_u32(glb, json.size());
    append_u32(glb, Json);
    glb += json;
    glb.append(reinterpret_cast<const char*>(rest.data()), rest.size());
    prepared->text = std::move(glb);
    return prepared;
}

}  // namespace tessera::import
