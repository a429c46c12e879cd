#pragma once

#include <span>
#include <string>
#include <vector>

#include "mediator/base/error.h"
#include "mediator/filter/filter.h"

namespace tessera::filter {

// A filter with its parameter values.
struct Choice {
    const FilterEntry* entry = nullptr;
    Values values;
    std::vector<std::string> hints;  // on old names of parameters

    frame::ChannelSet channels() const { return entry->description.channels(values); }
};

// NAME[:key=value,...]; empty means "none". InvalidInput names the problem and the valid names or range.
Expected<Choice> parse_choice(std::string_view text, std::span<const FilterEntry> table);

// Channels that the filter reads and `there` does not contain. Without a filter, Color suffices instead of Radiance.
frame::ChannelSet missing_channels(const Choice& choice, frame::ChannelSet there);

// The same, and channels without which the filter overestimates errors.
frame::ChannelSet wanted_channels(const Choice& choice, frame::ChannelSet there);

// Why this machine cannot run the filter, with the remedy; "" if it can.
std::string why_unavailable(const FilterEntry& entry);

// Why it cannot be used for a reproducible frame; "" if it can.
std::string why_not_reproducible(const FilterEntry& entry);

// Why the error of its pictures cannot be estimated by those of the halves of a film (master/render/adaptive/filtered_error.h);
// "" if it can. It may read features, but no statistics of radiance of which the film has no halves.
std::string why_no_error_estimate(const Choice& choice);

// The shortest text that parses to the same: default values are left out.
std::string to_text(const Choice& choice);

}  // namespace tessera::filter
