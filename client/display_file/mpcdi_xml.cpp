#include "client/display_file/mpcdi_xml.h"

#include <strings.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>

#include "mediator/base/error.h"
#include "mediator/display/display.h"

namespace tessera::display_file {

namespace {

bool is_same(const char* a, const char* b) {
    return strcasecmp(a, b) == 0;
}

pugi::xml_attribute attribute_of(pugi::xml_node node, const char* name) {
    return node.find_attribute([&](pugi::xml_attribute each) { return is_same(each.name(), name); });
}

}  // namespace

MpcdiXml::MpcdiXml(std::span<const std::byte> text, std::string name)
    : text_(reinterpret_cast<const char*>(text.data()), text.size()), name_(std::move(name)) {
    const pugi::xml_parse_result result = document_.load_buffer(text_.data(), text_.size());
    if (!result) refuse_at(result.offset, std::string("the XML is malformed: ") + result.description());
    if (!is_same(root().name(), "MPCDI"))
        refuse(root(), std::string("has the root element <") + root().name() + ">, not <MPCDI>");
}

std::vector<pugi::xml_node> MpcdiXml::all(pugi::xml_node below, const char* name) const {
    struct Walker : pugi::xml_tree_walker {
        const char* name;
        std::vector<pugi::xml_node> found;
        bool for_each(pugi::xml_node& node) override {
            if (is_same(node.name(), name)) found.push_back(node);
            return true;
        }
    } walker;
    walker.name = name;
    below.traverse(walker);
    return walker.found;
}

pugi::xml_node MpcdiXml::child(pugi::xml_node node, const char* name) const {
    for (const pugi::xml_node each : node.children())
        if (is_same(each.name(), name)) return each;
    return {};
}

std::string MpcdiXml::text(pugi::xml_node node, const char* attribute) const {
    return attribute_of(node, attribute).value();
}

std::string MpcdiXml::required(pugi::xml_node node, const char* attribute) const {
    std::string value = text(node, attribute);
    if (value.empty()) refuse(node, std::string("<") + node.name() + "> needs '" + attribute + "'");
    return value;
}

double MpcdiXml::parsed(pugi::xml_node at, const std::string& what, const char* text) const {
    while (*text == ' ' || *text == '+' || *text == '\n' || *text == '\t' || *text == '\r') ++text;
    double value = 0.0;
    const char* const last = text + std::strlen(text);
    const auto [end, error] = std::from_chars(text, last, value);
    const bool is_whole =
        std::all_of(end, last, [](char c) { return c == ' ' || c == '\n' || c == '\t' || c == '\r'; });
    if (error != std::errc{} || !is_whole || !std::isfinite(value) || std::abs(value) > 1e9)
        refuse(at, what + " must be a number, not '" + std::string(text).substr(0, 40) + "'");
    return value;
}

double MpcdiXml::number(pugi::xml_node node, const char* attribute, double otherwise) const {
    const pugi::xml_attribute found = attribute_of(node, attribute);
    return found ? parsed(node, std::string("'") + attribute + "'", found.value()) : otherwise;
}

std::uint32_t MpcdiXml::pixels(pugi::xml_node node, const char* attribute) const {
    required(node, attribute);
    const double value = number(node, attribute, 0.0);
    if (!(value >= 1.0 && value <= display::MaxEdge && value == std::floor(value)))
        refuse(node, std::string("'") + attribute + "' must be 1 to " + std::to_string(display::MaxEdge) +
                         " pixels");
    return static_cast<std::uint32_t>(value);
}

double MpcdiXml::number_in(pugi::xml_node node, const char* name, double otherwise) const {
    const pugi::xml_node found = child(node, name);
    return found ? parsed(found, std::string("<") + name + ">", found.child_value()) : otherwise;
}

double MpcdiXml::number_in(pugi::xml_node node, const char* name) const {
    if (!child(node, name)) refuse(node, std::string("<") + node.name() + "> needs <" + name + ">");
    return number_in(node, name, 0.0);
}

std::string MpcdiXml::text_in(pugi::xml_node node, const char* name) const {
    return child(node, name).child_value();
}

void MpcdiXml::refuse(pugi::xml_node at, const std::string& why) const {
    refuse_at(at.offset_debug(), why);
}

void MpcdiXml::refuse_at(std::ptrdiff_t offset, const std::string& why) const {
    const auto end = text_.begin() + std::clamp<std::ptrdiff_t>(offset, 0, std::ptrdiff_t(text_.size()));
    throw Error(
        ErrorCode::InvalidInput,
        name_ + ": mpcdi.xml:" + std::to_string(1 + std::count(text_.begin(), end, '\n')) + ": " + why);
}

}  // namespace tessera::display_file
