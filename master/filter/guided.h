#pragma once

#include "mediator/filter/filter.h"

namespace tessera::filter {

// Guided image filter (He et al. 2010; Bauszat et al. 2011 for rendering). In every square window the picture
// is fitted by a linear function of the features g, here albedo, normal and mean depth over depth:
//     a = (Cov(g, g) + epsilon I)^-1 Cov(g, picture),   b = mean(picture) - a . mean(g)
//     out(p) = mean(a) . g(p) + mean(b)     over the windows that p is in
// Features are divided by their standard deviation in the frame, so that epsilon is relative to their
// variance. Detail that no feature shows is blurred; smooth changes of a feature, as on a curved surface, are
// kept.
FilterEntry guided_entry();

}  // namespace tessera::filter
