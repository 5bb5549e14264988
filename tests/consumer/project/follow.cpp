// SPDX-License-Identifier: BSD-3-Clause
// The smallest robot program: frames in, poses and predicted objects out.
#include <headway/io/rawlog_source.h>
#include <headway/pipeline/perception.h>

#include <cstdio>

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  headway::io::RawlogSource source(argv[1], {});
  headway::pipeline::Perception perception(source.camera(), {});
  std::size_t tracked = 0;
  while (auto frame = source.next()) {
    const auto update = perception.process(*frame);
    if (update.camera.status == headway::slam::TrackingStatus::kTracked) ++tracked;
    if (frame->index == 40) break;
  }
  std::printf("%zu frames tracked, %zu objects\n", tracked,
              perception.map().movingObjects().tracks().size());
  return tracked == 41 ? 0 : 1;
}
