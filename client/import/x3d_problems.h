#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace tessera::import {

// What is wrong with an X3D file but does not keep the rest from being read. Equal problems are counted, and
// only so many kinds are kept: a hostile file does not make an endless list.
class X3dProblems {
  public:
    explicit X3dProblems(std::string text) : text_(std::move(text)) {}

    // `offset`: of a byte in the file's text.
    void add(const std::string& problem, std::ptrdiff_t offset);
    void skipped(const std::string& node, std::ptrdiff_t offset);  // a node that is not read

    std::string line(std::ptrdiff_t offset) const;  // "line 12"
    std::vector<std::string> notices() const;       // one phrase for each kind, with its first line
    std::string skipped() const;                    // "3 <Text>, 1 <Script>"; "" for none

  private:
    struct Times {
        std::size_t count = 0;
        std::ptrdiff_t first = 0;
    };
    using Kinds = std::map<std::string, Times, std::less<>>;

    void count(Kinds& kinds, const std::string& kind, std::ptrdiff_t offset);

    std::string text_;
    Kinds problems_, skipped_;
    std::size_t others_ = 0;  // of kinds beyond those that are kept
};

}  // namespace tessera::import
