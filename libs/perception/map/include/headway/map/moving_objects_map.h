// SPDX-License-Identifier: BSD-3-Clause
// Moving objects as an MRPT metric map, and their 3D picture.
#pragma once

#include <headway/core/object_class.h>
#include <headway/core/track.h>
#include <mrpt/maps/CMetricMap.h>

#include <vector>

namespace headway {

/// Moving objects as an MRPT metric map: the tracks at one time, with predictions.
///
/// The layer of PerceptionMap beside the landmarks. It is set from the tracker's output, not by
/// inserting observations, so that insertObservation() refuses all of them. Its name in an .ini of
/// a multi-metric map is `movingObjectsMap`:
///
///     [map]
///     pointsMap_count        = 1
///     movingObjectsMap_count = 1
///     [map_movingObjectsMap_00_insertOpts]
///     show_labels = true
class CMovingObjectsMap : public mrpt::maps::CMetricMap {
  DEFINE_SERIALIZABLE(CMovingObjectsMap, headway)

 public:
  /// Options of getVisualizationInto().
  struct TInsertionOptions : public mrpt::config::CLoadableOptions {
    bool show_tentative = false;   ///< also tentative tracks
    bool show_labels = true;       ///< class and id above each box, as 3D text
    bool show_predictions = true;  ///< predicted paths as green dashes
    bool show_uncertainty = true;  ///< bands around predictions, one standard deviation wide

    void loadFromConfigFile(const mrpt::config::CConfigFileBase& source,
                            const std::string& section) override;
    void dumpToTextStream(std::ostream& out) const override;
  };
  TInsertionOptions insertionOptions;
  /// Of the widths of paths and the lengths of dashes in a visualisation; 1 for streets. Not
  /// stored.
  double line_scale = 1.0;
  Colour prediction_colour = kPredictionColour;  ///< in a visualisation; not stored

  CMovingObjectsMap() = default;

  /// Replaces the contents by the tracks at one time [s].
  void setTracks(Time time, std::vector<Track> tracks);

  [[nodiscard]] Time time() const { return time_; }
  [[nodiscard]] const std::vector<Track>& tracks() const { return tracks_; }

  [[nodiscard]] bool isEmpty() const override { return tracks_.empty(); }
  [[nodiscard]] std::string asString() const override;
  /// Boxes coloured by class, past paths, predictions and labels; nothing if
  /// genericMapParams.enableSaveAs3DObject is off.
  void getVisualizationInto(mrpt::opengl::CSetOfObjects& out) const override;
  /// Writes `<prefix>_moving_objects.3Dscene` and `<prefix>_moving_objects.txt`.
  /// @throws InputError if a file cannot be written
  void saveMetricMapRepresentationToFile(const std::string& prefix) const override;

 private:
  void internal_clear() override;
  bool internal_insertObservation(
      const mrpt::obs::CObservation& observation,
      const std::optional<const mrpt::poses::CPose3D>& robot_pose) override;
  double internal_computeObservationLikelihood(
      const mrpt::obs::CObservation& observation,
      const mrpt::poses::CPose3D& taken_from) const override;
  bool internal_canComputeObservationLikelihood(
      const mrpt::obs::CObservation& observation) const override;

  Time time_ = 0.0;
  std::vector<Track> tracks_;

  MAP_DEFINITION_START(CMovingObjectsMap)
  headway::CMovingObjectsMap::TInsertionOptions insertionOpts;
  MAP_DEFINITION_END(CMovingObjectsMap)
};

}  // namespace headway
