#pragma once

#include <deque>
#include <optional>

#include "mediator/wire/messages.h"
#include "tests/fuzz/random_values.h"

namespace tessera::test {

// What a node knows of views and of its units, and film of them.
class FilmGenerator {
  public:
    explicit FilmGenerator(RandomValues& random) : random_(random) {}

    void got(const view::WorkUnit& unit);
    void got(const wire::OpenView& view);
    // `may_forge`: finite values for its own units, which only rendering them again could find out.
    wire::FilmPart film(Version version, bool may_forge);
    // One of its own, or of others, or none.
    UnitId some_unit();
    std::vector<UnitId> units() const;
    std::uint64_t dealt() const { return dealt_; }

  private:
    wire::FilmPart film_of_others();

    RandomValues& random_;
    std::deque<view::WorkUnit> units_;
    std::deque<wire::OpenView> views_;
    std::uint64_t dealt_ = 0, highest_ = 0;
};

}  // namespace tessera::test
