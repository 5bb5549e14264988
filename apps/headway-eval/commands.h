#pragma once

namespace headway::app {

/// Sub-commands of headway-eval; each parses its arguments and returns the exit status.
int runTrajectory(int argc, const char** argv);
int runTracks(int argc, const char** argv);
int runPredictions(int argc, const char** argv);
int runGrid(int argc, const char** argv);
int runSuite(int argc, const char** argv);

}  // namespace headway::app
