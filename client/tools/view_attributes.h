#pragma once

#include <map>
#include <string>
#include <vector>

#include "mediator/base/error.h"
#include "mediator/view/view.h"

namespace tessera::tools {

// Converts the view parameters that filters need to text attributes of an EXR, and back.
std::map<std::string, std::string> view_attributes(const view::View& view);
Expected<view::View> view_from_attributes(const std::map<std::string, std::string>& attributes);

const char* name(view::PathClass path_class);
const std::vector<std::string>& path_class_names();  // in the order of the enum

}  // namespace tessera::tools
