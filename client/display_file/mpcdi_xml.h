#pragma once

#include <pugixml.hpp>
#include <span>
#include <string>
#include <vector>

namespace tessera::display_file {

// mpcdi.xml, case-insensitive, since tools disagree on case. Throws Error{InvalidInput}:
// "NAME: mpcdi.xml:LINE: cause".
class MpcdiXml {
  public:
    MpcdiXml(std::span<const std::byte> text, std::string name);

    pugi::xml_node root() const { return document_.document_element(); }
    std::vector<pugi::xml_node> all(pugi::xml_node below, const char* name) const;  // at any depth
    pugi::xml_node child(pugi::xml_node node, const char* name) const;              // none: a null node

    std::string text(pugi::xml_node node, const char* attribute) const;  // "" if missing
    std::string required(pugi::xml_node node, const char* attribute) const;
    double number(pugi::xml_node node, const char* attribute, double otherwise) const;
    std::uint32_t pixels(pugi::xml_node node, const char* attribute) const;  // 1 to 16384
    // The text of a child element.
    double number_in(pugi::xml_node node, const char* name, double otherwise) const;
    double number_in(pugi::xml_node node, const char* name) const;
    std::string text_in(pugi::xml_node node, const char* name) const;

    [[noreturn]] void refuse(pugi::xml_node at, const std::string& why) const;

  private:
    double parsed(pugi::xml_node at, const std::string& what, const char* text) const;
    [[noreturn]] void refuse_at(std::ptrdiff_t offset, const std::string& why) const;

    std::string text_, name_;
    pugi::xml_document document_;
};

}  // namespace tessera::display_file
