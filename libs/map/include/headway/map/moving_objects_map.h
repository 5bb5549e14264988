#pragma once

#include <headway/core/track.h>
#include <mrpt/maps/CMetricMap.h>

#include <vector>

namespace headway {

/// What moves in the world, as an MRPT metric map: the tracks at one time, with predictions.
///
/// The second layer of the one shared map, beside the landmarks. It is filled by the tracker and
/// not by inserting observations, so insertObservation() refuses all of them. In an .ini of a
/// multi-metric map it is called `movingObjectsMap`:
///
///     [map]
///     pointsMap_count        = 1
///     movingObjectsMap_count = 1
///     [map_movingObjectsMap_00_insertOpts]
///     show_labels = true
class CMovingObjectsMap : public mrpt::maps::CMetricMap {
  DEFINE_SERIALIZABLE(CMovingObjectsMap, headway)

 public:
  /// How getVisualizationInto() shows the tracks.
  struct TInsertionOptions : public mrpt::config::CLoadableOptions {
    bool show_tentative = false;   ///< also tracks that are not believed yet
    bool show_labels = true;       ///< class and id above each box, as 3D text
    bool show_predictions = true;  ///< predicted paths as green dashes
    bool show_uncertainty = true;  ///< bands around predictions, one standard deviation wide

    void loadFromConfigFile(const mrpt::config::CConfigFileBase& source,
                            const std::string& section) override;
    void dumpToTextStream(std::ostream& out) const override;
  };
  TInsertionOptions insertionOptions;

  CMovingObjectsMap() = default;

  /// Replaces all that is known by the tracks at one time.
  void setTracks(Time time, std::vector<Track> tracks);

  [[nodiscard]] Time time() const { return time_; }
  [[nodiscard]] const std::vector<Track>& tracks() const { return tracks_; }

  [[nodiscard]] bool isEmpty() const override { return tracks_.empty(); }
  [[nodiscard]] std::string asString() const override;
  /// Boxes coloured by class, past paths, predictions and labels; nothing where the map's
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
