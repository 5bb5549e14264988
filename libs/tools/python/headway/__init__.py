# SPDX-License-Identifier: BSD-3-Clause
"""Perception among moving objects for mobile robots built on MRPT.

    import headway

    source = headway.RawlogSource("street.rawlog")
    perception = headway.Perception(source.camera)
    for frame, update in headway.Session(source, perception):
        print(update.time, update.status, update.T_map_robot[:3, 3], len(update.tracks))

Lengths are in metres, times in seconds since the Unix epoch, angles in radians. The map's z axis
points up; a pose `T_a_b` is a 4x4 matrix that maps points of frame b into frame a.
"""

from ._headway import (
    Collision,
    Detection,
    Detections,
    Finding,
    Frame,
    Grid,
    InputError,
    Map,
    MapQuery,
    NearTrack,
    NearTracks,
    Occupancy,
    Perception,
    PredictedPath,
    RawlogSink,
    RawlogSource,
    Session,
    StereoCamera,
    Track,
    TrackSample,
    Update,
    __version__,
    evaluate_dense,
    evaluate_grid,
    evaluate_movers,
    evaluate_predictions,
    evaluate_tracks,
    evaluate_trajectory,
    load_map,
    read_predictions,
    read_track_array,
    read_tracks,
    read_trajectory,
)

__all__ = [
    "Collision",
    "Detection",
    "Detections",
    "Finding",
    "Frame",
    "Grid",
    "InputError",
    "Map",
    "MapQuery",
    "NearTrack",
    "NearTracks",
    "Occupancy",
    "Perception",
    "PredictedPath",
    "RawlogSink",
    "RawlogSource",
    "Session",
    "StereoCamera",
    "Track",
    "TrackSample",
    "Update",
    "evaluate_dense",
    "evaluate_grid",
    "evaluate_movers",
    "evaluate_predictions",
    "evaluate_tracks",
    "evaluate_trajectory",
    "load_map",
    "read_predictions",
    "read_track_array",
    "read_tracks",
    "read_trajectory",
]

for _name in __all__:
    if isinstance(globals()[_name], type):
        globals()[_name].__module__ = __name__  # where users find it
