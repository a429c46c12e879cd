#pragma once

#include <string>

#include "mediator/view/view.h"

namespace tessera::master {

// What it means for a film under way that its view is to have another filter, or other values of it. Pure.
struct FilterChange {
    enum class Effect : std::uint8_t {
        Kept,      // the film has all that the filter reads: no sample is taken again
        Widened,   // channels are added: they come with the samples from now on
        Restarted  // the film tells apart too little for this filter
    };
    Effect effect = Effect::Kept;
    view::View view;   // as it is rendered with the filter; its film keeps all channels that it has
    std::string text;  // for a person: what it means, or why the film cannot go on
};

// `now`: as it is rendered; `filter`: a valid one.
FilterChange filter_change(const view::View& now, const std::string& filter);

}  // namespace tessera::master
