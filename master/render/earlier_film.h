#pragma once

#include <string>

#include "mediator/frame/film_state.h"
#include "mediator/session/view_request.h"

namespace tessera::master {

// Why the view cannot go on with film of a client; "" = it can. `completed`: with the channels that it will have.
std::string problem_of(const frame::FilmState& film, const session::ViewRequest& completed);

}  // namespace tessera::master
