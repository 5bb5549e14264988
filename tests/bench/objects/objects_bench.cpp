// What the moving-object layer costs: each predictor for one object, and the whole layer for n.
//
//     bench_objects [--benchmark_filter=Predict]

#include <benchmark/benchmark.h>
#include <headway/objects/moving_object_tracker.h>
#include <headway/objects/predictor.h>

#include <cmath>
#include <random>

namespace {

using namespace headway;
using namespace headway::objects;

// Two seconds of a car that turns and brakes a little.
MotionHistory turningCar() {
  MotionHistory history;
  history.object_class = ObjectClass::kCar;
  for (int k = -20; k <= 0; ++k) {
    const double t = 0.1 * k;
    const double angle = 0.2 * t;
    history.path.push_back({static_cast<std::size_t>(k + 20),
                            t,
                            {8.0 * t - 0.3 * t * t, 40.0 * (1.0 - std::cos(angle)), 0.8},
                            angle});
  }
  return history;
}

void predict(benchmark::State& state) {
  const auto& name = predictorNames().at(static_cast<std::size_t>(state.range(0)));
  const auto predictor = makePredictor(predictorKindFrom(name), PredictorParams());
  const MotionHistory history = turningCar();
  std::vector<PredictedPath> paths;
  for (auto _ : state) {
    predictor->predictInto(history, paths);
    benchmark::DoNotOptimize(paths.data());
  }
  state.SetLabel(name);
}
BENCHMARK(predict)->DenseRange(0, 7);

// Objects on a field of constant density; every second one walks.
std::vector<Detection> crowd(int count, double time, std::mt19937& random) {
  std::normal_distribution<double> noise(0.0, 0.05);
  const int columns = std::max(1, static_cast<int>(std::sqrt(count)));
  std::vector<Detection> items;
  for (int i = 0; i < count; ++i) {
    Detection detection;
    detection.object_class = ObjectClass::kPedestrian;
    Box3d box;
    box.centre = {3.0 * (i % columns) + noise(random), 0.5,
                  5.0 + 3.0 * (i / columns) + noise(random)};
    if (i % 2 == 0) box.centre.x() += 1.2 * time;
    box.length = 0.8;
    box.width = 0.6;
    box.height = 1.7;
    detection.box3d = box;
    items.push_back(detection);
  }
  return items;
}

void wholeLayer(benchmark::State& state) {
  const int count = static_cast<int>(state.range(0));
  ObjectsParams params;
  params.consistency.max_range_m = 1e4;
  MovingObjectTracker tracker(params);
  std::mt19937 random(1);
  std::size_t frame = 0;
  std::size_t tracks = 0;
  for (auto _ : state) {
    state.PauseTiming();
    const double time = 0.1 * static_cast<double>(frame);
    Detections detections;
    detections.time = time;
    detections.items = crowd(count, std::fmod(time, 1.0), random);
    state.ResumeTiming();
    const auto update = tracker.update(frame++, {time, Pose::Identity()}, detections);
    tracks = update.tracks.size();
    benchmark::DoNotOptimize(tracks);
  }
  state.counters["tracks"] = static_cast<double>(tracks);
  state.SetComplexityN(count);
}
BENCHMARK(wholeLayer)->Arg(10)->Arg(50)->Arg(100)->Arg(300)->Arg(1000)->Iterations(100);

}  // namespace
