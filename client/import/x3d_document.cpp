#include "client/import/x3d_document.h"

#include <charconv>
#include <cstring>
#include <map>
#include <unordered_set>

#include "client/import/local_files.h"

namespace tessera::import {
namespace {

std::string text_of(const std::filesystem::path& file) {
    const auto bytes = read_whole_file(file);
    if (!bytes) throw bytes.error();
    std::string text(reinterpret_cast<const char*>(bytes->data()), bytes->size());
    // UTF-16 and UTF-32 have zero bytes in the first characters of "<?xml".
    if (std::string_view(text).substr(0, 4).find('\0') != std::string_view::npos) {
        throw Error(ErrorCode::InvalidInput, "it is not text in UTF-8: save it as UTF-8");
    }
    return text;
}

// Metadata does not affect the picture.
bool is_node(pugi::xml_node node) {
    const std::string_view kind = node.name();
    return node.type() == pugi::node_element && kind != "WorldInfo" && !kind.starts_with("Metadata");
}

// Length of the UTF-8 sequence at the start, 0 if it is invalid. Overlong three- and four-byte forms are
// accepted.
std::size_t sequence_length(std::string_view text) {
    const auto lead = static_cast<unsigned char>(text.front());
    const std::size_t length = lead < 0x80 ? 1 : lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : lead >= 0xc2 ? 2 : 0;
    if (length == 0 || lead > 0xf4 || text.size() < length) return 0;
    for (std::size_t i = 1; i < length; ++i) {
        if ((static_cast<unsigned char>(text[i]) & 0xc0) != 0x80) return 0;
    }
    return length;
}

}  // namespace

std::string x3d_name(std::string_view words) {
    constexpr std::size_t Longest = 256;
    std::string name;
    while (!words.empty() && name.size() < Longest) {
        const std::size_t length = sequence_length(words);
        name += length > 0 ? words.substr(0, length) : std::string_view("?");
        words.remove_prefix(std::max<std::size_t>(length, 1));
    }
    return name;
}

std::string x3d_name(pugi::xml_node node) {
    return x3d_name(node.attribute("DEF").value());
}

X3dDocument::X3dDocument(const std::filesystem::path& file) : X3dDocument(text_of(file)) {}

X3dDocument::X3dDocument(std::string text) : diagnostics_(text) {
    const pugi::xml_parse_result result =
        document_.load_buffer(text.data(), text.size(), pugi::parse_default, pugi::encoding_utf8);
    if (!result) {
        throw Error(ErrorCode::InvalidInput, diagnostics_.line(result.offset) + ": the XML is broken (" +
                                                 result.description() + "): export it again");
    }
    const pugi::xml_node root = document_.document_element();
    if (std::strcmp(root.name(), "X3D") != 0) {
        throw Error(ErrorCode::InvalidInput, diagnostics_.line(root.offset_debug()) + ": it begins with <" +
                                                 std::string(root.name()).substr(0, 60) +
                                                 ">, not with <X3D>: export it as X3D");
    }
    scene_ = root.child("Scene");
    if (!scene_) {
        throw Error(ErrorCode::InvalidInput,
                    diagnostics_.line(root.offset_debug()) + ": <X3D> has no <Scene>: export it again");
    }
    const std::string_view version = root.attribute("version").value();
    double number = 0.0;
    if (std::from_chars(version.data(), version.data() + version.size(), number).ec == std::errc{} &&
        number > 0.0)
        version_ = number;
    resolve_uses();
}

// Without recursion: the nesting depth is only bounded by the length of the file.
void X3dDocument::resolve_uses() {
    std::unordered_map<std::string_view, pugi::xml_node> defined;
    std::unordered_set<const void*> open;
    const auto enter = [&](pugi::xml_node node) {
        open.insert(node.internal_object());
        if (const pugi::xml_attribute use = node.attribute("USE")) {
            const auto found = defined.find(use.value());
            const std::string named = "USE='" + std::string(use.value()).substr(0, 60) + "' ";
            pugi::xml_node target;
            if (found == defined.end()) {
                diagnostics_.add(named + "refers to no earlier DEF: the node is ignored",
                                 node.offset_debug());
            } else if (open.contains(found->second.internal_object())) {
                diagnostics_.add(named + "is inside its own DEF: the node is ignored", node.offset_debug());
            } else {
                target = found->second;
            }
            uses_.emplace(node.internal_object(), target);
        } else if (const pugi::xml_attribute name = node.attribute("DEF")) {
            defined[name.value()] = node;
        }
    };
    pugi::xml_node node = scene_;
    enter(node);
    while (node) {
        if (const pugi::xml_node first = node.first_child()) {
            node = first;
        } else {
            while (node != scene_ && !node.next_sibling()) {
                open.erase(node.internal_object());
                node = node.parent();
            }
            open.erase(node.internal_object());
            node = node == scene_ ? pugi::xml_node() : node.next_sibling();
        }
        if (node.type() == pugi::node_element) enter(node);
    }
}

std::vector<X3dDocument::Child> X3dDocument::children(pugi::xml_node node) {
    std::vector<Child> children;
    for (const pugi::xml_node each : node.children()) {
        if (!is_node(each)) continue;
        const auto use = uses_.find(each.internal_object());
        const pugi::xml_node meant = use == uses_.end() ? each : use->second;
        if (meant) children.push_back({meant, each.attribute("containerField").value()});
    }
    return children;
}

pugi::xml_node X3dDocument::child(pugi::xml_node node, const char* kind) {
    for (const Child& each : children(node)) {
        if (std::strcmp(each.node.name(), kind) == 0) return each.node;
    }
    return {};
}

}  // namespace tessera::import
