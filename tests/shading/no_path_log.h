#pragma once

#include "tests/shading/test_scene.h"

// Path logging for C++: does nothing.
namespace tessera::shading {

template <class... Arguments>
void log_camera(const Context&, const Arguments&...) {}
template <class... Arguments>
void log_hit(const Context&, const Arguments&...) {}
template <class... Arguments>
void log_miss(const Context&, const Arguments&...) {}
template <class... Arguments>
void log_emission(const Context&, const Arguments&...) {}
template <class... Arguments>
void log_light(const Context&, const Arguments&...) {}
template <class... Arguments>
void log_specular(const Context&, const Arguments&...) {}
template <class Context, class... Arguments>
void log_receiver(const Context&, const Arguments&...) {}

}  // namespace tessera::shading
