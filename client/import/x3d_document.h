#pragma once

#include <filesystem>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "client/import/x3d_problems.h"

namespace tessera::import {

// An X3D file in its XML encoding, every USE resolved. Throws Error{InvalidInput} with the line where the XML
// is broken or is no X3D.
class X3dDocument {
  public:
    explicit X3dDocument(const std::filesystem::path& file);

    pugi::xml_node scene() const { return scene_; }
    double version() const { return version_; }  // 3.3 where the file does not say

    // The children that are nodes, each with its USE followed: what it names is the nearest DEF before it.
    // A USE of nothing, or inside its own DEF, is a problem and left out; metadata is left out.
    struct Child {
        pugi::xml_node node;
        std::string container;  // its containerField where it stands, "" where it says none
    };
    std::vector<Child> children(pugi::xml_node node);
    // The first child of that kind; a null node when there is none.
    pugi::xml_node child(pugi::xml_node node, const char* kind);

    X3dProblems& problems() { return problems_; }

  private:
    explicit X3dDocument(std::string text);
    void resolve_uses();

    X3dProblems problems_;
    pugi::xml_document document_;
    pugi::xml_node scene_;
    double version_ = 3.3;
    std::unordered_map<const void*, pugi::xml_node> uses_;  // by the node that has the USE; null = left out
};

// Words of the file as a name: in valid UTF-8 and not endless.
std::string x3d_name(std::string_view words);
std::string x3d_name(pugi::xml_node node);  // its DEF, "" without

}  // namespace tessera::import
