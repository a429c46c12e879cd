#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace tessera::test {

// How many messages of each kind all peers have sent.
class Traffic {
  public:
    void sent(std::string_view kind);
    std::uint64_t total() const { return total_; }
    // Of the kinds, the one that was sent least.
    std::size_t rarest(const std::vector<std::string_view>& kinds) const;
    double share(std::string_view kind) const;

  private:
    std::map<std::string, std::uint64_t, std::less<>> counts_;
    std::uint64_t total_ = 0;
};

}  // namespace tessera::test
