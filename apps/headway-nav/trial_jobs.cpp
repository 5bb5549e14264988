// SPDX-License-Identifier: BSD-3-Clause
// Trials side by side in several processes.
#include "trial_jobs.h"

#include <headway/core/error.h>
#include <headway/program/progress.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <exception>
#include <map>
#include <nlohmann/json.hpp>
#include <opencv2/core/utility.hpp>

#include "policy_figures.h"

namespace headway::app {

void to_json(nlohmann::json& json, const TrialResult& trial) {
  json = {trial.seed,
          trial.goal_reached,
          trial.time_to_goal_s,
          trial.min_distance_m,
          trial.collided,
          trial.walked_into,
          trial.pillar_touched,
          trial.unsafe_steps,
          trial.step_us,
          trial.sense_us,
          trial.drive ? nlohmann::json(*trial.drive) : nlohmann::json()};
}

void from_json(const nlohmann::json& json, TrialResult& trial) {
  std::size_t i = 0;
  const auto next = [&](auto& value) { json.at(i++).get_to(value); };
  next(trial.seed);
  next(trial.goal_reached);
  next(trial.time_to_goal_s);
  next(trial.min_distance_m);
  next(trial.collided);
  next(trial.walked_into);
  next(trial.pillar_touched);
  next(trial.unsafe_steps);
  next(trial.step_us);
  next(trial.sense_us);
  if (!json.at(i).is_null()) next(trial.drive.emplace());
}

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(TrialOutcome, results, written)

namespace {

using Start = std::function<std::function<TrialOutcome(std::size_t)>()>;

/// A process that runs every so many-th trial and writes what came of it into a pipe.
struct Worker {
  pid_t pid = -1;
  int pipe = -1;
  std::vector<std::uint8_t> received;
};

/// Length of what follows: CBOR of [trial, outcome], or of a text that says what failed.
using Header = std::uint64_t;

void send(int pipe, const nlohmann::json& message) {
  const auto content = nlohmann::json::to_cbor(message);
  const Header length = content.size();
  std::vector<std::uint8_t> bytes(sizeof length);
  std::memcpy(bytes.data(), &length, sizeof length);
  bytes.insert(bytes.end(), content.begin(), content.end());
  for (std::size_t sent = 0; sent < bytes.size();) {
    const ssize_t count = write(pipe, bytes.data() + sent, bytes.size() - sent);
    if (count < 0 && errno != EINTR) _exit(1);
    if (count > 0) sent += static_cast<std::size_t>(count);
  }
}

[[noreturn]] void work(int pipe, std::size_t first, std::size_t step, std::size_t count,
                       const Start& start) {
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
  cv::setNumThreads(1);  // the other cores have trials of their own
  try {
    const auto run = start();
    for (std::size_t i = first; i < count; i += step) send(pipe, {i, run(i)});
  } catch (const std::exception& error) {
    send(pipe, error.what());
  }
  _exit(0);
}

/// The processes; those that still run end with it.
class Workers {
 public:
  Workers(std::size_t jobs, std::size_t count, const Start& start) {
    for (std::size_t k = 0; k < jobs; ++k) {
      int ends[2];
      if (::pipe(ends) != 0) throw InputError("no pipe can be opened for a job");
      const pid_t pid = fork();
      if (pid < 0) throw InputError("no process can be started for a job; use fewer --jobs");
      if (pid == 0) {
        close(ends[0]);
        work(ends[1], k, jobs, count, start);
      }
      close(ends[1]);
      workers_.push_back({pid, ends[0], {}});
    }
  }
  ~Workers() {
    for (const Worker& worker : workers_) {
      if (worker.pipe >= 0) {
        kill(worker.pid, SIGTERM);
        close(worker.pipe);
      }
      waitpid(worker.pid, nullptr, 0);
    }
  }
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  /// Waits up to 0.2 s for messages and hands them on; false when no process is left.
  bool receive(const std::function<void(const nlohmann::json&)>& take) {
    std::vector<pollfd> polled;
    for (const Worker& worker : workers_) polled.push_back({worker.pipe, POLLIN, 0});
    poll(polled.data(), polled.size(), 200);
    bool is_any = false;
    for (std::size_t k = 0; k < workers_.size(); ++k) {
      if (polled[k].revents != 0) read(workers_[k], take);
      is_any = is_any || workers_[k].pipe >= 0;
    }
    return is_any;
  }

 private:
  static void read(Worker& worker, const std::function<void(const nlohmann::json&)>& take) {
    std::uint8_t buffer[65536];
    const ssize_t count = ::read(worker.pipe, buffer, sizeof buffer);
    if (count == 0) {
      close(worker.pipe);
      worker.pipe = -1;
    }
    if (count <= 0) return;
    auto& bytes = worker.received;
    bytes.insert(bytes.end(), buffer, buffer + count);
    Header length = 0;
    while (bytes.size() >= sizeof length) {
      std::memcpy(&length, bytes.data(), sizeof length);
      if (bytes.size() < sizeof length + length) return;
      const auto begin = bytes.begin() + sizeof length, end = begin + static_cast<long>(length);
      take(nlohmann::json::from_cbor(begin, end));
      bytes.erase(bytes.begin(), end);
    }
  }

  std::vector<Worker> workers_;
};

}  // namespace

std::vector<TrialOutcome> runTrials(int jobs, std::size_t count, const Start& start,
                                    const std::function<void(std::size_t)>& done) {
  std::map<std::size_t, TrialOutcome> outcomes;
  if (jobs == 1) {
    const auto run = start();
    for (std::size_t i = 0; i < count && !program::interrupted(); ++i) {
      outcomes[i] = run(i);
      done(outcomes.size());
    }
  } else {
    Workers workers(std::min(static_cast<std::size_t>(jobs), count), count, start);
    const auto take = [&](const nlohmann::json& message) {
      if (message.is_string()) throw InputError(message.get<std::string>());
      message.at(1).get_to(outcomes[message.at(0).get<std::size_t>()]);
      done(outcomes.size());
    };
    while (!program::interrupted() && workers.receive(take)) continue;
    if (!program::interrupted() && outcomes.size() < count) {
      throw InputError("a job has ended before its last trial");
    }
  }
  std::vector<TrialOutcome> all;
  for (auto& [index, outcome] : outcomes) {
    if (index != all.size()) break;
    all.push_back(std::move(outcome));
  }
  return all;
}

}  // namespace headway::app
