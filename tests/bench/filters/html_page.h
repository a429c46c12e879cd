#pragma once

#include <string_view>

// The parts of the page that no measurement changes.
namespace tessera::tools::bench {

std::string_view page_style();
std::string_view page_script();  // fills the comparison from the crops that are on the page

}  // namespace tessera::tools::bench
