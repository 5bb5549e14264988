// SPDX-License-Identifier: BSD-3-Clause
#include "live_options.h"

#include <headway/core/error.h>
#include <headway/pipeline/perception_params.h>

#include <filesystem>

namespace headway::live {

void describe(LiveOptions& options, program::CommandLine& line) {
  options.run.program = "headway-live";
  options.run.snapshots = 0;
  line.option(options.sensors, 0, "sensors", "SENSORS.ini",
              "Sensors to grab, in the format of MRPT's rawlog-grabber", true);
  line.option(options.run.output, 'o', "output", "OUTDIR", "Folder for all results");
  line.option(options.plugins, 0, "load-plugins", "LIB.so,...",
              "Shared libraries with further classes of CGenericSensor");
  line.option(options.calibration, 0, "calibration", "FILE",
              "calibration.yaml that replaces the cameras' calibration and poses");
  line.option(options.record, 0, "record", "OUT.rawlog", "Rawlog of all observations to write");
  line.option(options.run.load_map, 0, "load-map", "MAP",
              "Localise in this map.headway and extend it (slam.mapping=false: localise only)");
  line.option(options.run.sensor_label, 0, "sensor-label", "LABEL",
              "Stereo camera to use if there are several; LEFT,RIGHT for two cameras");
  line.option(options.pair_tolerance_s, 0, "pair-tolerance", "SECONDS",
              "Maximum difference of time of the images of two cameras; default 0.01");
  line.option(
      options.show_port, 0, "show", "PORT",
      "Serve a page at http://127.0.0.1:PORT that shows images, map and health; 0: any port");
  line.option(options.show_address, 0, "show-address", "ADDRESS",
              "Address to serve the page on instead; its URL then contains a secret token");
  line.option(options.run.detector, 0, "detector", "NAME",
              "Source of boxes; default: detect.detector of the configuration");
  line.flag(options.run.overwrite, 'w', "overwrite", "Overwrite existing results");
}

void check(const LiveOptions& options) {
  using program::UsageError;
  if (options.run.output.empty()) {
    throw UsageError("-o/--output: is required (--help shows the options)");
  }
  if (!(options.pair_tolerance_s >= 0.0)) {
    throw UsageError("--pair-tolerance must not be negative");
  }
  if (!options.run.detector.empty()) {
    try {
      pipeline::checkDetectorNames(options.run.detector);
    } catch (const InputError& error) {
      throw UsageError(std::string("--detector: ") + error.what());
    }
  }
  if (options.show_port && *options.show_port > 65535) {
    throw UsageError("--show: ports are 0 to 65535");
  }
  if (!options.show_port && options.show_address != LiveOptions().show_address) {
    throw UsageError("--show-address has no effect without --show");
  }
  if (!options.record.empty()) {
    if (std::filesystem::path(options.record).extension() == ".zst") {
      throw UsageError("--record: recordings are compressed by gzip; name it OUT.rawlog");
    }
    program::requireWritable(options.record, options.run.overwrite,
                             {options.sensors, options.calibration, options.run.load_map});
  }
}

}  // namespace headway::live
