#pragma once

#include "finished_replay.h"
#include "options.h"

namespace headway::render_program {

/// Writes the replay's page anew, with the errors and true paths where a truth is given.
///
/// @throws InputError
void writeReportPage(const Options& options, const Note& note);

}  // namespace headway::render_program
