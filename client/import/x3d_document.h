#pragma once

#include <filesystem>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "client/import/x3d_diagnostics.h"

namespace tessera::import {

// An X3D file in XML encoding, with every USE resolved. Throws Error{InvalidInput} with the line if the XML
// is broken or is not X3D.
class X3dDocument {
  public:
    explicit X3dDocument(const std::filesystem::path& file);

    pugi::xml_node scene() const { return scene_; }
    double version() const { return version_; }  // 3.3 if the file has no version

    // The child nodes, with each USE replaced by the nearest earlier DEF of that name. A USE without DEF or
    // inside its own DEF is reported and ignored; metadata is ignored.
    struct Child {
        pugi::xml_node node;
        std::string container;  // its containerField, "" if it has none
    };
    std::vector<Child> children(pugi::xml_node node);
    // The first child of that kind; a null node if there is none.
    pugi::xml_node child(pugi::xml_node node, const char* kind);

    X3dDiagnostics& diagnostics() { return diagnostics_; }

  private:
    explicit X3dDocument(std::string text);
    void resolve_uses();

    X3dDiagnostics diagnostics_;
    pugi::xml_document document_;
    pugi::xml_node scene_;
    double version_ = 3.3;
    std::unordered_map<const void*, pugi::xml_node> uses_;  // by the node that has the USE; null = ignored
};

// Text of the file as a name: valid UTF-8 of limited length.
std::string x3d_name(std::string_view words);
std::string x3d_name(pugi::xml_node node);  // its DEF, "" if it has none

}  // namespace tessera::import
