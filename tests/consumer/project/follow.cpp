// SPDX-License-Identifier: BSD-3-Clause
// The smallest robot program: frames in, poses and predicted objects out.
#include <headway/run/session.h>

#include <cstdio>

/// A sink takes results: it writes files, draws, publishes; this one counts.
class Count : public headway::run::Sink {
 public:
  void onFrame(const headway::run::FrameResult& result, headway::pipeline::Perception&) override {
    if (result.update.camera.status == headway::slam::TrackingStatus::kTracked) ++tracked;
  }
  std::size_t tracked = 0;
};

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  headway::io::RawlogSourceOptions options;
  options.to_index = 40;
  headway::run::RawlogFrames source(argv[1], options);
  headway::pipeline::Perception perception(source.camera(), {});
  Count count;
  headway::run::Session(source, perception, {&count}).run();
  std::printf("%zu frames tracked, %zu objects\n", count.tracked,
              perception.map().movingObjects().tracks().size());
  return count.tracked == 41 ? 0 : 1;
}
