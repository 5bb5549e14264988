#pragma once

#include "options.h"

namespace headway::render_program {

/// Draws what the options ask for.
///
/// @throws InputError
void render(const Options& options);

}  // namespace headway::render_program
