#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace tessera::import {

// Recoverable problems of an X3D file. Equal problems are counted, and the number of kinds is limited, which
// bounds the log of a malformed file.
class X3dDiagnostics {
  public:
    explicit X3dDiagnostics(std::string text) : text_(std::move(text)) {}

    // `offset`: byte offset in the text of the file.
    void add(const std::string& problem, std::ptrdiff_t offset);
    void skipped(const std::string& node, std::ptrdiff_t offset);  // an unsupported node

    std::string line(std::ptrdiff_t offset) const;  // "line 12"
    std::vector<std::string> notices() const;       // one line per kind, with the first place in the file
    std::string skipped() const;                    // "3 <Text>, 1 <Script>"; "" for none

  private:
    struct Occurrences {
        std::size_t count = 0;
        std::ptrdiff_t first = 0;
    };
    using Kinds = std::map<std::string, Occurrences, std::less<>>;

    void count(Kinds& kinds, const std::string& kind, std::ptrdiff_t offset);

    std::string text_;
    Kinds diagnostics_, skipped_;
    std::size_t overflow_ = 0;  // occurrences of kinds beyond the limit
};

}  // namespace tessera::import
