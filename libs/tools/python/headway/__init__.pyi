# SPDX-License-Identifier: BSD-3-Clause
from types import TracebackType
from typing import Any, Iterable, Mapping, Optional, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

__version__: str

Array = NDArray[np.float64]

class InputError(ValueError): ...

class StereoCamera:
    width: int
    height: int
    fx: float
    fy: float
    cx: float
    cy: float
    baseline_m: float
    T_robot_cam: Array
    depth_reach_m: float
    def __init__(
        self,
        *,
        width: int,
        height: int,
        fx: float,
        fy: float,
        cx: float,
        cy: float,
        baseline_m: Optional[float] = None,
        T_robot_cam: Optional[ArrayLike] = None,
        depth_reach_m: float = 0.0,
    ) -> None: ...

class Detection:
    object_class: str
    score: float
    box2d: Optional[list[float]]
    centre: Optional[Array]
    size: Optional[Array]
    yaw: Optional[float]
    def __init__(
        self,
        *,
        object_class: str,
        score: float = 1.0,
        box2d: Optional[Sequence[float]] = None,
        centre: Optional[ArrayLike] = None,
        size: Optional[ArrayLike] = None,
        yaw: float = 0.0,
    ) -> None: ...

class Detections:
    time: float
    items: list[Detection]
    def __init__(
        self,
        time: float,
        items: Sequence[Detection],
        T_robot_sensor: Optional[ArrayLike] = None,
    ) -> None: ...
    def __len__(self) -> int: ...

class Frame:
    index: int
    time: float
    left: Optional[NDArray[np.uint8]]
    right: Optional[NDArray[np.uint8]]
    left_colour: Optional[NDArray[np.uint8]]
    disparity: Optional[NDArray[np.float32]]
    depth: Optional[NDArray[np.float32]]
    T_map_robot: Optional[Array]
    detections: Optional[Detections]
    def __init__(
        self,
        index: int,
        time: float,
        left: NDArray[np.uint8],
        right: NDArray[np.uint8],
        camera: StereoCamera,
    ) -> None: ...
    @staticmethod
    def from_depth(
        index: int,
        time: float,
        image: NDArray[np.uint8],
        depth: NDArray[np.floating[Any]],
        camera: StereoCamera,
    ) -> Frame: ...

class RawlogSource:
    camera: Optional[StereoCamera]
    skipped: dict[str, int]
    truncation: Optional[str]
    def __init__(
        self,
        path: str,
        *,
        sensor_label: str = "",
        from_index: int = 0,
        to_index: Optional[int] = None,
        use_odometry: bool = True,
        use_imu: bool = True,
    ) -> None: ...
    def __iter__(self) -> RawlogSource: ...
    def __next__(self) -> Frame: ...

class RawlogSink:
    def __init__(self, path: str, *, storage: str = "embedded") -> None: ...
    def write_stereo(
        self,
        time: float,
        left: NDArray[np.uint8],
        right: NDArray[np.uint8],
        camera: StereoCamera,
        label: str = "stereo",
    ) -> None: ...
    def write_depth(
        self,
        time: float,
        image: NDArray[np.uint8],
        depth: NDArray[np.floating[Any]],
        camera: StereoCamera,
        label: str = "rgbd",
    ) -> None: ...
    def write_detections(self, label: str, detections: Detections) -> None: ...
    def write_pose(self, label: str, time: float, T_map_robot: ArrayLike) -> None: ...
    def write_odometry(self, time: float, x: float, y: float, yaw: float) -> None: ...
    def write_imu(
        self, time: float, angular_velocity: ArrayLike, acceleration: ArrayLike
    ) -> None: ...
    def close(self) -> None: ...
    def __enter__(self) -> RawlogSink: ...
    def __exit__(
        self,
        type: Optional[type[BaseException]],
        value: Optional[BaseException],
        traceback: Optional[TracebackType],
    ) -> None: ...

class PredictedPath:
    mode: int
    probability: float
    horizons_s: list[float]
    positions: Array
    covariances: Array

class Track:
    id: int
    object_class: str
    status: str
    motion: str
    score: float
    position: Array
    velocity: Array
    yaw: float
    yaw_rate: float
    size: Array
    position_covariance: Array
    velocity_covariance: Array
    first_seen: float
    last_seen: float
    recent_path: Array
    predictions: list[PredictedPath]

class TrackSample:
    frame: int
    time: float
    track: Track

class Finding:
    name: str
    frame: int
    text: str
    is_fatal: bool

class Update:
    frame: int
    time: float
    status: str
    doubt: str
    T_map_robot: Array
    T_odom_robot: Array
    T_map_odom: Array
    map_revision: tuple[int, str]
    covariance: Array
    is_keyframe: bool
    inliers: int
    tracks: list[Track]
    tracks_odom: list[Track]
    finalised: list[TrackSample]
    detections: Optional[Detections]
    detections_dropped: dict[str, int]
    findings: list[Finding]

class Occupancy:
    status: str
    probability: float
    static_probability: float
    moving_probability: float

class NearTrack:
    id: int
    object_class: str
    centre: Array
    velocity: Array
    distance_m: float
    sigma_m: float

class NearTracks:
    status: str
    items: list[NearTrack]

class Collision:
    status: str
    is_free: bool
    probability: float
    earliest_s: Optional[float]
    likely_s: Optional[float]
    unknown_from_s: Optional[float]
    with_track: Optional[int]

class MapQuery:
    status: str
    age_s: float
    def occupancy_at(self, x: float, y: float, time: float) -> Occupancy: ...
    def tracks_near(self, place: ArrayLike, radius_m: float, time: float) -> NearTracks: ...
    def time_to_collision(
        self, *, length_m: float, width_m: float, path: ArrayLike
    ) -> Collision: ...

class Grid:
    occupancy: NDArray[np.float32]
    origin: Array
    resolution_m: float

class Map:
    landmarks: Array
    keyframes: Array
    grid: Optional[Grid]
    tracks: list[Track]
    time: float
    def at(self, now: float, *, max_age_s: float = 0.5) -> MapQuery: ...

class Perception:
    map: Map
    trajectory: Array
    warnings: dict[str, tuple[int, int, str]]
    def __init__(
        self,
        camera: Optional[StereoCamera],
        *,
        config: Mapping[str, Any] = {},
        config_files: Sequence[str] = [],
        live: bool = False,
    ) -> None: ...
    def process(self, frame: Frame) -> Update: ...
    def finish(self) -> None: ...
    def flush(self) -> list[TrackSample]: ...
    def resume(self, path: str) -> None: ...
    def save_map(self, path: str) -> None: ...

class Session:
    def __init__(self, frames: Iterable[Frame], perception: Perception) -> None: ...
    def __iter__(self) -> Session: ...
    def __next__(self) -> tuple[Frame, Update]: ...

def load_map(path: str) -> Map: ...
def read_trajectory(path: str) -> Array: ...
def read_tracks(path: str) -> list[TrackSample]: ...
def read_track_array(path: str) -> NDArray[np.void]: ...
def read_predictions(path: str) -> NDArray[np.void]: ...
def evaluate_trajectory(
    truth: ArrayLike,
    estimate: ArrayLike,
    *,
    align: str = "se3",
    max_difference_s: float = 0.02,
    segments_m: Sequence[float] = [100.0, 200.0, 300.0, 400.0, 500.0, 600.0, 700.0, 800.0],
) -> dict[str, Any]: ...
def evaluate_tracks(
    truth: str,
    estimate: str,
    *,
    metric: str = "3d",
    classes: Sequence[str] = ["Car", "Pedestrian", "Cyclist"],
    min_overlap: Optional[float] = None,
    raw: Optional[str] = None,
) -> dict[str, Any]: ...
def evaluate_movers(truth: str, poses: str, estimate: str) -> dict[str, Any]: ...
def evaluate_predictions(
    truth: str, poses: str, estimate: str, *, extrinsic: Optional[str] = None
) -> dict[str, Any]: ...
def evaluate_grid(
    truth: str,
    estimate: str,
    *,
    min_obstacle_height_m: Optional[float] = None,
    max_obstacle_height_m: Optional[float] = None,
) -> dict[str, Any]: ...
def evaluate_dense(
    truth: str, estimate: str, *, rawlog: Optional[str] = None
) -> dict[str, Any]: ...
