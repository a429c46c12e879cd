#pragma once

#include "tests/shading/world.h"

// The story of a path, for C++: nobody listens.
namespace tessera::shading {

template <class... Told>
void tell_camera(const Context&, const Told&...) {}
template <class... Told>
void tell_hit(const Context&, const Told&...) {}
template <class... Told>
void tell_miss(const Context&, const Told&...) {}
template <class... Told>
void tell_emission(const Context&, const Told&...) {}
template <class... Told>
void tell_light(const Context&, const Told&...) {}
template <class... Told>
void tell_specular(const Context&, const Told&...) {}

}  // namespace tessera::shading
