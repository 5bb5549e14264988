// SPDX-License-Identifier: BSD-3-Clause
// headway-render: picture, video, 3D scene or report of a finished replay.
#include "options.h"

int main(int argc, char** argv) {
  return headway::program::run("headway-render", [&] {
    headway::render_program::Options options;
    headway::program::CommandLine line("headway-render",
                                       "Draws a finished replay: the dense map, landmarks, the "
                                       "robot's path, boxes with ids, past paths and "
                                       "predictions.");
    headway::render_program::describe(options, line);
    if (!line.parse(argc, argv)) return headway::program::kDone;
    options.quiet = line.quiet();
    headway::render_program::resolve(options);
    headway::render_program::render(options);
    return headway::program::kDone;
  });
}
