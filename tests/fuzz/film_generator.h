#pragma once

#include <deque>
#include <set>

#include "mediator/wire/messages.h"
#include "tests/fuzz/random_values.h"

namespace tessera::test {

// What a node knows of views and of its units, film of them, and failures. It also invents both for units of other nodes.
class FilmGenerator {
  public:
    // `highest_unit`: that any peer knows of; other nodes hold units with ids close to it.
    FilmGenerator(RandomValues& random, std::uint64_t& highest_unit)
        : random_(random), highest_unit_(highest_unit) {}

    void add(const view::WorkUnit& unit);
    void add(const wire::OpenView& view);
    // `may_forge`: finite values for its own units, which only rendering them again could find out.
    wire::FilmPart film(Version version, bool may_forge);
    // `may_fail`: units of its own, too, which counts when a second node agrees.
    wire::UnitReleased release(bool may_fail);
    std::vector<UnitId> units() const;
    std::uint64_t dealt() const { return dealt_.size(); }

  private:
    wire::FilmPart film_of_others();
    UnitId unit_of_others();

    RandomValues& random_;
    std::uint64_t& highest_unit_;
    std::deque<view::WorkUnit> units_;  // not yet sent or released
    std::set<UnitId> dealt_;            // to this node, at any time
    std::deque<wire::OpenView> views_;
    UnitId latest_of_others_;
};

}  // namespace tessera::test
