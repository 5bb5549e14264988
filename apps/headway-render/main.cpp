// headway-render: a finished replay in; a picture, a video or a 3D scene out.
#include "options.h"
#include "render.h"

int main(int argc, char** argv) {
  return headway::program::run("headway-render", [&] {
    headway::render_program::Options options;
    headway::program::CommandLine line(
        "headway-render",
        "Draws a finished replay: landmarks, the robot's path, boxes with ids, past paths and "
        "predictions.");
    headway::render_program::describe(options, line);
    if (!line.parse(argc, argv)) return headway::program::kDone;
    options.quiet = line.quiet();
    headway::render_program::resolve(options);
    headway::render_program::render(options);
    return headway::program::kDone;
  });
}
