#pragma once

#include <string>

#include "mediator/view/view.h"

namespace tessera::master {

// How a change of a view's filter, or of its parameters, affects a film in progress. Pure.
struct FilterChange {
    enum class Effect : std::uint8_t {
        Kept,      // the film has all channels that the filter reads: no sample is taken again
        Widened,   // channels are added: later samples have them
        Restarted  // the film does not separate the path classes that this filter needs
    };
    Effect effect = Effect::Kept;
    view::View view;   // as it is rendered with the filter; its film keeps all channels that it has
    std::string text;  // for users: the effect, or why the film cannot be continued
};

// `now`: as it is rendered; `filter`: a valid one.
FilterChange filter_change(const view::View& now, const std::string& filter);

// As users know them, separated by commas.
std::string channel_names(frame::ChannelSet channels);

}  // namespace tessera::master
