// SPDX-License-Identifier: BSD-3-Clause
// Cost of the moving-object layer: each predictor for one object, the whole layer for n objects
// (with the exponent of its growth), the solver of the smoother against Eigen's sparse one, and the
// whole layer on KITTI's sequences if HEADWAY_DATA names the folder of kitti_tracking/.
//
//     HEADWAY_DATA=DATA bench_objects [--benchmark_filter=predict|wholeLayer|kittiTracking]

#include <benchmark/benchmark.h>
#include <headway/io/dataset.h>
#include <headway/objects/moving_object_tracker.h>
#include <headway/objects/predictor.h>
#include <motion_prior.h>

#include <Eigen/SparseCholesky>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <map>
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

/// The smoother's system for a window of 20 frames: diagonally dominant blocks of 2 x 2.
BandedSystem<2> smootherSystem() {
  BandedSystem<2> system;
  system.reset(21);
  for (std::size_t i = 0; i < system.diagonal.size(); ++i) {
    system.diagonal[i] << 9.0, 0.5, 0.5, 8.0;
    system.first[i] << -2.0, 0.1, 0.1, -2.0;
    system.second[i] << 0.5, 0.0, 0.0, 0.5;
    system.right[i] << 1.0, -1.0;
  }
  return system;
}

void bandedSolve(benchmark::State& state) {
  const auto system = smootherSystem();
  BandedSystem<2> work;
  for (auto _ : state) {
    work = system;
    work.solve();
    benchmark::DoNotOptimize(work.right.data());
  }
}
BENCHMARK(bandedSolve);

/// The same system with Eigen's sparse solver, the symbolic analysis done once.
void sparseSolve(benchmark::State& state) {
  const auto system = smootherSystem();
  std::vector<Eigen::Triplet<double>> entries;
  const auto add = [&entries](std::size_t row, std::size_t column, const Eigen::Matrix2d& block) {
    for (int r = 0; r < 2; ++r) {
      for (int c = 0; c < 2; ++c) {
        entries.emplace_back(static_cast<int>(2 * row) + r, static_cast<int>(2 * column) + c,
                             block(r, c));
      }
    }
  };
  const std::size_t n = system.diagonal.size();
  for (std::size_t i = 0; i < n; ++i) {
    add(i, i, system.diagonal[i]);
    if (i + 1 < n) add(i + 1, i, system.first[i]);
    if (i + 2 < n) add(i + 2, i, system.second[i]);
  }
  Eigen::SparseMatrix<double> matrix(2 * static_cast<Eigen::Index>(n),
                                     2 * static_cast<Eigen::Index>(n));
  const Eigen::VectorXd right = Eigen::VectorXd::Ones(matrix.rows());
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver;
  matrix.setFromTriplets(entries.begin(), entries.end());
  solver.analyzePattern(matrix);
  for (auto _ : state) {
    matrix.setFromTriplets(entries.begin(), entries.end());
    solver.factorize(matrix);
    Eigen::VectorXd solution = solver.solve(right);
    benchmark::DoNotOptimize(solution.data());
  }
}
BENCHMARK(sparseSolve);

double secondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// Mean seconds a frame by the number of objects, to see how the cost grows from 50 on.
std::map<int, double>& costs() {
  static std::map<int, double> kCosts;
  return kCosts;
}

void wholeLayer(benchmark::State& state) {
  const int count = static_cast<int>(state.range(0));
  ObjectsParams params;
  params.consistency.max_range_m = 1e4;
  MovingObjectTracker tracker(params);
  std::mt19937 random(1);
  std::size_t frame = 0;
  std::size_t tracks = 0;
  double total_s = 0.0;
  for (auto _ : state) {
    const double time = 0.1 * static_cast<double>(frame);
    Detections detections;
    detections.time = time;
    detections.items = crowd(count, std::fmod(time, 1.0), random);
    const auto start = std::chrono::steady_clock::now();
    const auto update = tracker.update(frame++, {time, Pose::Identity()}, detections);
    const double cost_s = secondsSince(start);
    state.SetIterationTime(cost_s);
    total_s += cost_s;
    tracks = update.tracks.size();
    benchmark::DoNotOptimize(tracks);
  }
  state.counters["tracks"] = static_cast<double>(tracks);
  constexpr int kReference = 50;
  costs()[count] = total_s / static_cast<double>(frame);
  if (count > kReference && costs().count(kReference) > 0) {
    state.counters["exponent_from_50"] =
        std::log(costs()[count] / costs()[kReference]) / std::log(1.0 * count / kReference);
  }
}
BENCHMARK(wholeLayer)
    ->Arg(10)
    ->Arg(50)
    ->Arg(100)
    ->Arg(300)
    ->Arg(1000)
    ->Iterations(100)
    ->UseManualTime()
    ->Unit(benchmark::kMicrosecond);
BENCHMARK(wholeLayer)->Arg(10000)->Iterations(5)->UseManualTime()->Unit(benchmark::kMillisecond);

// The ten sequences on which trackers are compared, all three classes; reading is not counted.
void kittiTracking(benchmark::State& state) {
  const char* data = std::getenv("HEADWAY_DATA");
  if (data == nullptr) return state.SkipWithError("HEADWAY_DATA names no folder of real data");
  std::vector<std::vector<io::DatasetFrame>> sequences;
  for (const char* name :
       {"0001", "0006", "0008", "0010", "0012", "0013", "0014", "0015", "0016", "0018"}) {
    const auto dataset = io::openKittiTracking(std::string(data) + "/kitti_tracking", name,
                                               io::KittiBoxes::kPointRcnn3d);
    auto& frames = sequences.emplace_back();
    for (std::size_t k = 0; k < dataset->size(); ++k) frames.push_back(dataset->frame(k));
  }
  std::int64_t done = 0;
  for (auto _ : state) {
    for (const auto& frames : sequences) {
      MovingObjectTracker tracker{ObjectsParams()};
      for (std::size_t k = 0; k < frames.size(); ++k) {
        const auto& frame = frames[k];
        const auto update = tracker.update(k, {frame.time, *frame.T_map_robot}, *frame.detections);
        benchmark::DoNotOptimize(update.tracks.data());
        ++done;
      }
    }
  }
  state.counters["frames/s"] =
      benchmark::Counter(static_cast<double>(done), benchmark::Counter::kIsRate);
}
BENCHMARK(kittiTracking)->Unit(benchmark::kMillisecond);

}  // namespace
