#pragma once

#include <span>
#include <string>

#include "mediator/base/error.h"
#include "mediator/filter/filter.h"

namespace tessera::filter {

// A filter of a table with its values.
struct Choice {
    const FilterEntry* entry = nullptr;
    Values values;

    frame::ChannelSet channels() const { return entry->description.channels(values); }
};

// NAME[:key=value,...]; empty means "none". InvalidInput names what is wrong, its range and the nearest name.
Expected<Choice> parse_choice(std::string_view text, std::span<const FilterEntry> table);

// What the filter reads and `there` lacks. Without a filter the picture may be Color as well as Radiance.
frame::ChannelSet lacking(const Choice& choice, frame::ChannelSet there);

// The shortest text that parses to the same: values that are standard are left out.
std::string to_text(const Choice& choice);

}  // namespace tessera::filter
