#pragma once

#include "client/import/scene_builder.h"

namespace tessera::import {

// What every scene gets at the end: background and environment from the options, else the file's own, and,
// where they ask for what is missing, a soft sky when nothing is light (Glow says which surfaces are), a
// camera that frames everything when there is none. Throws Error when the environment cannot be read or there
// is nothing to draw.
void finish(SceneBuilder& builder, scene::Background of_file = {});

// A camera that sees all of `bounds` (a box of 1 m around the origin where they are empty), with a notice.
void add_framing_camera(SceneBuilder& builder, const Bounds& bounds);

}  // namespace tessera::import
