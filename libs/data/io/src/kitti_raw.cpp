// SPDX-License-Identifier: BSD-3-Clause
// KITTI's raw data: a drive's images, true path, sensors and labelled objects.
#include "kitti_raw.h"

#include <headway/core/detection.h>
#include <headway/core/error.h>
#include <headway/io/dataset.h>
#include <headway/io/image_file.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "image_files.h"
#include "text_rows.h"

namespace headway::io {
namespace {

namespace fs = std::filesystem;

/// One packet of KITTI's GNSS and inertial unit. The unit's axes are x forward, y left, z up.
struct OxtsPacket {
  Time time = 0.0;
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
  double altitude_m = 0.0;
  double roll = 0.0, pitch = 0.0, yaw = 0.0;  ///< of the unit; yaw 0 is east, positive left [rad]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();          ///< east, north, up [m/s]
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();      ///< unit's axes [m/s^2]
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  ///< unit's axes [rad/s]
  int satellites = 0;
  double position_sigma_m = 0.0;  ///< as the unit states it; 0: unknown
};

constexpr double kEarthRadius_m = 6378137.0;  // of the Mercator projection, as KITTI's kit has it
constexpr double kMaxOxtsGap_s = 0.3;         // of packets at 10 Hz, of which one may be missing
constexpr double kMaxExtrapolation_s = 0.05;  // half a packet's interval
constexpr double kRadPerDegree = M_PI / 180.0;

OxtsPacket readPacket(const std::string& path) {
  TextRows rows(path);
  if (!rows.next()) throw InputError(path + ": is empty; an OXTS packet has 30 values");
  rows.requireSize(30, "an OXTS packet");
  for (std::size_t i = 0; i < 23; ++i) {
    if (!std::isfinite(rows.number(i)))
      rows.fail("value " + std::to_string(i + 1) + " is not finite");
  }
  OxtsPacket packet;
  packet.latitude_deg = rows.number(0);
  packet.longitude_deg = rows.number(1);
  packet.altitude_m = rows.number(2);
  if (std::abs(packet.latitude_deg) >= 90.0) rows.fail("the latitude is not between -90 and 90");
  packet.roll = rows.number(3);
  packet.pitch = rows.number(4);
  packet.yaw = rows.number(5);
  packet.velocity = {rows.number(7), rows.number(6), rows.number(10)};  // ve, vn, vu
  packet.acceleration = {rows.number(11), rows.number(12), rows.number(13)};
  packet.angular_velocity = {rows.number(17), rows.number(18), rows.number(19)};
  packet.satellites = static_cast<int>(rows.integer(26));
  packet.position_sigma_m = rows.number(23);
  return packet;
}

/// Position in metres, x east, y north.
Eigen::Vector3d mercator(const OxtsPacket& packet, double scale) {
  const double radius = scale * kEarthRadius_m;
  const double half_colatitude = (90.0 + packet.latitude_deg) * kRadPerDegree / 2.0;
  return {radius * packet.longitude_deg * kRadPerDegree,
          radius * std::log(std::tan(half_colatitude)), packet.altitude_m};
}

Eigen::Matrix3d rotationOf(const OxtsPacket& packet) {
  using Eigen::AngleAxisd;
  return (AngleAxisd(packet.yaw, Eigen::Vector3d::UnitZ()) *
          AngleAxisd(packet.pitch, Eigen::Vector3d::UnitY()) *
          AngleAxisd(packet.roll, Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

/// The times of a KITTI raw `timestamps.txt`: one row "YYYY-MM-DD hh:mm:ss.sss" per frame, UTC.
///
/// @throws InputError naming file and line of an error
std::vector<Time> readKittiTimestamps(const std::string& path) {
  std::vector<Time> times;
  TextRows rows(path);
  while (rows.next()) {
    std::tm date{};
    double second = 0.0;
    const bool has_two = rows.size() == 2;
    const bool is_date = has_two && std::sscanf(rows.fields()[0].c_str(), "%4d-%2d-%2d",
                                                &date.tm_year, &date.tm_mon, &date.tm_mday) == 3;
    const bool is_time = has_two && std::sscanf(rows.fields()[1].c_str(), "%2d:%2d:%lf",
                                                &date.tm_hour, &date.tm_min, &second) == 3;
    if (!is_date || !is_time) rows.fail("is not a time 'YYYY-MM-DD hh:mm:ss.sss'");
    date.tm_year -= 1900;
    date.tm_mon -= 1;
    times.push_back(static_cast<double>(timegm(&date)) + second);
  }
  return times;
}

/// Reads `data/NNNNNNNNNN.txt` (30 values each) and `timestamps.txt` of a folder `oxts`, in time
/// order.
///
/// @param dropped  counts packets without a time, and packets whose time does not increase
///                 ("oxts_without_time", "oxts_time_backwards")
/// @throws InputError naming file and line of an error
std::vector<OxtsPacket> readOxts(const std::string& folder,
                                 std::map<std::string, std::size_t>& dropped) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(fs::path(folder) / "data")) {
    if (entry.path().extension() == ".txt") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  const auto times = readKittiTimestamps((fs::path(folder) / "timestamps.txt").string());
  std::vector<OxtsPacket> packets;
  for (const auto& file : files) {
    const auto number = parseNumber(file.stem().string());
    if (!number || !(*number >= 0.0) || *number >= static_cast<double>(times.size())) {
      ++dropped["oxts_without_time"];
      continue;
    }
    OxtsPacket packet = readPacket(file.string());
    packet.time = times[static_cast<std::size_t>(*number)];
    if (!packets.empty() && packet.time <= packets.back().time) {
      ++dropped["oxts_time_backwards"];
      continue;
    }
    packets.push_back(packet);
  }
  return packets;
}

/// Poses of the unit, in a frame with x east, y north, z up.
///
/// kPositions: Mercator projection at the scale of the first packet's latitude; kVelocities:
/// velocities integrated by the trapezoidal rule, from the origin.
///
/// @see Geiger et al. 2013, "Vision meets robotics: the KITTI dataset", Sec. III-A and its raw data
///      development kit
std::vector<Stamped<Pose>> oxtsPath(const std::vector<OxtsPacket>& packets, OxtsPath path) {
  std::vector<Stamped<Pose>> poses;
  if (packets.empty()) return poses;
  const double scale = std::cos(packets.front().latitude_deg * kRadPerDegree);
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k < packets.size(); ++k) {
    const auto& packet = packets[k];
    if (path == OxtsPath::kPositions) {
      position = mercator(packet, scale);
    } else if (k > 0) {
      const auto& previous = packets[k - 1];
      position += 0.5 * (packet.time - previous.time) * (packet.velocity + previous.velocity);
    }
    Pose pose = Pose::Identity();
    pose.linear() = rotationOf(packet);
    pose.translation() = position;
    poses.push_back({packet.time, pose});
  }
  return poses;
}

/// The pose at a time, interpolated between packets, or extrapolated by up to 0.05 s; nullopt in
/// gaps of more than 0.3 s and beyond.
std::optional<Pose> oxtsPoseAt(const std::vector<Stamped<Pose>>& path, Time time) {
  if (path.size() < 2) return std::nullopt;
  if (time < path.front().time - kMaxExtrapolation_s) return std::nullopt;
  if (time > path.back().time + kMaxExtrapolation_s) return std::nullopt;
  auto after = std::lower_bound(path.begin() + 1, path.end() - 1, time,
                                [](const auto& pose, Time t) { return pose.time < t; });
  const auto& [end_time, end] = *after;
  const auto& [start_time, start] = *(after - 1);
  if (end_time - start_time > kMaxOxtsGap_s) return std::nullopt;
  const double ratio = (time - start_time) / (end_time - start_time);
  Pose pose = start;
  pose.translation() += ratio * (end.translation() - start.translation());
  pose.linear() =
      start.linear() * expSo3(ratio * logSo3(start.linear().transpose() * end.linear()));
  return pose;
}

/// Reads the elements of an XML text in order of their tags, without attributes. By hand, because
/// all tracklets have one simple layout, and errors name its line.
class XmlScanner {
 public:
  explicit XmlScanner(const std::string& path) : path_(path) {
    std::ifstream file(path);
    if (!file) throw InputError(path + ": cannot be opened");
    text_.assign(std::istreambuf_iterator<char>(file), {});
  }

  /// Name of the next start or end tag ("item", "/item"); nullopt at the end of the text. Content
  /// before it is returned by content().
  std::optional<std::string> next() {
    const auto open = text_.find('<', position_);
    if (open == text_.npos) return std::nullopt;
    content_ = text_.substr(position_, open - position_);
    const auto close = text_.find('>', open);
    if (close == text_.npos) fail("a tag is not closed");
    position_ = close + 1;
    return text_.substr(open + 1, text_.find_first_of(" >", open) - open - 1);
  }

  [[nodiscard]] const std::string& content() const { return content_; }

  [[nodiscard]] double number(const std::string& tag) const {
    const auto value = parseNumber(content_);
    if (!value || !std::isfinite(*value)) fail("<" + tag + "> is not a number: '" + content_ + "'");
    return *value;
  }

  [[noreturn]] void fail(const std::string& reason) const {
    const auto line =
        1 + std::count(text_.begin(), text_.begin() + static_cast<long>(position_), '\n');
    throw InputError(path_ + ":" + std::to_string(line) + ": " + reason);
  }

 private:
  std::string path_;
  std::string text_;
  std::size_t position_ = 0;
  std::string content_;
};

/// Values of one tracklet or of one of its poses, by tag.
using Values = std::map<std::string, double>;

constexpr double kMaxFrame = 1e9;  // of any drive

class TrackletReader {
 public:
  TrackletReader(const std::string& path, const Pose& T_cam_velo,
                 std::map<std::string, std::size_t>& dropped)
      : xml_(path), T_cam_velo_(T_cam_velo), dropped_(dropped) {}

  std::map<std::size_t, Detections> read() {
    bool has_tracklets = false;
    for (auto tag = xml_.next(); tag; tag = xml_.next()) {
      if (*tag == "tracklets") has_tracklets = true;
      if (has_tracklets && *tag == "item") readTracklet();
      if (*tag == "/tracklets") return std::move(frames_);
    }
    xml_.fail(has_tracklets ? "ends within <tracklets>" : "contains no <tracklets>");
  }

 private:
  std::string nextTag() {
    const auto tag = xml_.next();
    if (!tag) xml_.fail("ends within a tracklet");
    return *tag;
  }

  void readTracklet() {
    Values sizes;
    std::string type;
    for (auto tag = nextTag(); tag != "/item"; tag = nextTag()) {
      if (tag == "/objectType") type = xml_.content();
      if (tag == "/h" || tag == "/w" || tag == "/l" || tag == "/first_frame") {
        sizes[tag.substr(1)] = xml_.number(tag);
      }
      if (tag == "poses") readPoses(type, sizes);
    }
    ++next_id_;
  }

  void readPoses(const std::string& type, const Values& sizes) {
    for (const char* name : {"h", "w", "l", "first_frame"}) {
      if (sizes.count(name) == 0) xml_.fail(std::string("the tracklet has no <") + name + ">");
    }
    if (!(sizes.at("first_frame") >= 0.0 && sizes.at("first_frame") <= kMaxFrame)) {
      xml_.fail("<first_frame> is no index of a frame");
    }
    auto frame = static_cast<std::size_t>(sizes.at("first_frame"));
    for (auto tag = nextTag(); tag != "/poses"; tag = nextTag()) {
      if (tag == "item") addPose(type, sizes, readPose(), frame++);
    }
  }

  Values readPose() {
    Values pose;
    for (auto tag = nextTag(); tag != "/item"; tag = nextTag()) {
      if (tag[0] == '/') pose[tag.substr(1)] = xml_.number(tag);
    }
    for (const char* name : {"tx", "ty", "tz", "rz", "truncation"}) {
      if (pose.count(name) == 0) xml_.fail(std::string("the pose has no <") + name + ">");
    }
    return pose;
  }

  void addPose(const std::string& type, const Values& sizes, const Values& pose,
               std::size_t frame) {
    const auto object_class = objectClassFrom(type == "Person (sitting)" ? "Person_sitting" : type);
    if (!object_class) {
      ++dropped_["unknown_class"];
      return;
    }
    if (pose.at("truncation") > 1.0) {  // 0: in the image, 1: truncated, 2: outside, 3: behind
      ++dropped_["tracklet_outside_image"];
      return;
    }
    Detection detection;
    detection.object_class = *object_class;
    detection.detector_id = next_id_;
    Box3d box;
    box.length = sizes.at("l");
    box.width = sizes.at("w");
    box.height = sizes.at("h");
    const Eigen::Vector3d bottom(pose.at("tx"), pose.at("ty"), pose.at("tz"));
    box.centre = T_cam_velo_ * (bottom + Eigen::Vector3d(0.0, 0.0, 0.5 * box.height));
    const double yaw = pose.at("rz");
    box.yaw = opticalYaw(T_cam_velo_.linear() * Eigen::Vector3d(std::cos(yaw), std::sin(yaw), 0.0));
    detection.box3d = box;
    frames_[frame].items.push_back(detection);
  }

  XmlScanner xml_;
  Pose T_cam_velo_;
  std::map<std::string, std::size_t>& dropped_;
  std::int64_t next_id_ = 0;
  std::map<std::size_t, Detections> frames_;
};

/// Reads the labelled objects of a KITTI raw drive (`tracklet_labels.xml`) by frame.
///
/// Ids are the tracklets' positions in the file. Boxes have no 2D box.
///
/// @param T_cam_velo  lidar frame in rectified camera 0, the frame of the resulting boxes
/// @param dropped     counts boxes outside the image ("tracklet_outside_image") and of other
///                    classes ("unknown_class")
/// @throws InputError naming the file and the tracklet of an error
std::map<std::size_t, Detections> readKittiTracklets(const std::string& path,
                                                     const Pose& T_cam_velo,
                                                     std::map<std::string, std::size_t>& dropped) {
  return TrackletReader(path, T_cam_velo, dropped).read();
}

/// Pose of a rigid motion in a calibration file: "R:" row-major and "T:".
Pose readRigid(const fs::path& path) {
  const auto matrices = readKittiCalibration(path.string());
  const auto R = kittiMatrix(matrices, "R", 9, path.string());
  const auto T = kittiMatrix(matrices, "T", 3, path.string());
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(R.data());
  pose.translation() = Eigen::Map<const Eigen::Vector3d>(T.data());
  return normalized(pose);
}

/// Calibration of one day of recording.
struct DayCalibration {
  KittiProjection P_left, P_right;
  cv::Size size;
  Pose T_cam_velo = Pose::Identity();  ///< lidar frame in rectified camera 0
  Pose T_cam_imu = Pose::Identity();   ///< GNSS and inertial unit in rectified camera 0
};

DayCalibration readDay(const fs::path& folder) {
  const std::string path = (folder / "calib_cam_to_cam.txt").string();
  const auto matrices = readKittiCalibration(path);
  const auto matrix = [&](const char* name, std::size_t size) {
    return kittiMatrix(matrices, name, size, path).data();
  };
  using RowMajor34 = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;
  using RowMajor33 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  DayCalibration day;
  day.P_left = Eigen::Map<const RowMajor34>(matrix("P_rect_00", 12));
  day.P_right = Eigen::Map<const RowMajor34>(matrix("P_rect_01", 12));
  const double* size = matrix("S_rect_00", 2);
  for (const double side : {size[0], size[1]}) {
    if (!(side >= 1.0 && side <= kMaxImageSide)) throw InputError(path + ": S_rect_00 is no size");
  }
  day.size = cv::Size(static_cast<int>(size[0]), static_cast<int>(size[1]));
  Pose T_rectified_cam = Pose::Identity();
  T_rectified_cam.linear() = Eigen::Map<const RowMajor33>(matrix("R_rect_00", 9));
  day.T_cam_velo = normalized(T_rectified_cam * readRigid(folder / "calib_velo_to_cam.txt"));
  day.T_cam_imu = day.T_cam_velo * readRigid(folder / "calib_imu_to_velo.txt");
  return day;
}

void readFrames(const fs::path& folder, KittiRawDrive& drive) {
  const auto left = (fs::path("image_00") / "data").string();
  const auto right = (fs::path("image_01") / "data").string();
  const auto pairs = kittiImagePairs(folder, left, right, drive.dropped);
  const std::string path = (folder / "image_00" / "timestamps.txt").string();
  const auto times = readKittiTimestamps(path);
  for (const auto& pair : pairs) {
    if (pair.number >= times.size()) {
      throw InputError(path + ": has " + std::to_string(times.size()) + " times, none for image " +
                       std::to_string(pair.number));
    }
    drive.frames.push_back({times[pair.number], pair, std::nullopt});
  }
}

void requireRectified(const cv::Mat& image, cv::Size size, const std::string& path) {
  if (image.size() == size) return;
  const auto text = [](cv::Size s) {
    return std::to_string(s.width) + "x" + std::to_string(s.height);
  };
  throw InputError(path + ": the image has " + text(image.size()) +
                   " pixels, but the calibration's rectified images have " + text(size) +
                   "; only rectified drives (DATE_drive_NNNN_sync) can be read");
}

/// Level frame at the position and heading of a pose.
Pose levelled(const Pose& pose) {
  Pose level = Pose::Identity();
  level.linear() = Eigen::AngleAxisd(yawOf(pose), Eigen::Vector3d::UnitZ()).toRotationMatrix();
  level.translation() = pose.translation();
  return level;
}

void addTruth(const std::vector<Stamped<Pose>>& T_world_imu, const Pose& T_imu_robot,
              KittiRawDrive& drive) {
  std::optional<Pose> T_map_world;
  for (auto& frame : drive.frames) {
    const auto pose = oxtsPoseAt(T_world_imu, frame.time);
    if (!pose) {
      ++drive.dropped["frame_without_truth"];
      continue;
    }
    const Pose T_world_robot = *pose * T_imu_robot;
    if (!T_map_world) T_map_world = levelled(T_world_robot).inverse();
    frame.truth_T_map_robot = *T_map_world * T_world_robot;
  }
}

void addSensors(const std::vector<OxtsPacket>& packets, const Pose& T_robot_imu,
                KittiRawDrive& drive) {
  const Eigen::Matrix3d R_robot_imu = T_robot_imu.linear();
  for (const auto& packet : packets) {
    drive.inertial.push_back(
        {packet.time, R_robot_imu * packet.angular_velocity, R_robot_imu * packet.acceleration});
    drive.gnss.push_back({packet.time, T_robot_imu, packet.latitude_deg, packet.longitude_deg,
                          packet.altitude_m, packet.velocity, packet.satellites,
                          packet.position_sigma_m});
  }
}

class KittiRaw : public Dataset {
 public:
  KittiRaw(const fs::path& folder, OxtsPath path) : drive_(readKittiRawDrive(folder, path)) {
    const fs::path tracklets = folder / "tracklet_labels.xml";
    if (!fs::exists(tracklets)) return;
    tracklets_ = readKittiTracklets(tracklets.string(), drive_.T_cam_velo, drive_.dropped);
    std::set<std::size_t> numbers;
    for (const auto& frame : drive_.frames) numbers.insert(frame.images.number);
    for (const auto& [number, objects] : *tracklets_) {
      if (numbers.count(number) == 0) drive_.dropped["frame_without_image"] += objects.items.size();
    }
  }

  std::size_t size() const override { return drive_.frames.size(); }

  DatasetFrame frame(std::size_t index) const override {
    const auto& recorded = drive_.frames.at(index);
    DatasetFrame frame = recorded.load();
    if (!tracklets_) return frame;
    const auto objects = tracklets_->find(recorded.images.number);
    frame.truth_objects = objects == tracklets_->end() ? Detections{} : objects->second;
    frame.truth_objects->time = recorded.time;
    return frame;
  }

  std::optional<RawStereoCamera> camera() const override { return drive_.camera; }
  std::vector<DatasetInertial> inertial() const override { return drive_.inertial; }
  std::vector<RecordedGnss> gnss() const override { return drive_.gnss; }
  std::map<std::string, std::size_t> dropped() const override { return drive_.dropped; }

 private:
  KittiRawDrive drive_;
  std::optional<std::map<std::size_t, Detections>> tracklets_;  ///< by number of the image
};

}  // namespace

DatasetFrame KittiRawDrive::Frame::load() const {
  DatasetFrame frame;
  frame.time = time;
  frame.left = requireImage(images.left);
  frame.right = requireImage(images.right);
  frame.truth_T_map_robot = truth_T_map_robot;
  return frame;
}

KittiRawDrive readKittiRawDrive(const fs::path& folder, OxtsPath path) {
  if (!fs::is_directory(folder)) throw InputError(folder.string() + ": is not a folder");
  const fs::path given = folder.filename().empty() ? folder.parent_path() : folder;
  const auto day = readDay(fs::absolute(given).parent_path());
  KittiRawDrive drive;
  readFrames(folder, drive);
  const auto& first = drive.frames.front().images;
  requireRectified(requireImage(first.left), day.size, first.left);
  drive.camera = kittiCamera(day.P_left, day.size, day.P_right, requireImage(first.right).size());
  drive.T_cam_velo = day.T_cam_velo;
  if (fs::is_directory(folder / "oxts")) {
    const auto packets = readOxts((folder / "oxts").string(), drive.dropped);
    const Pose T_robot_imu = robotFromOptical() * day.T_cam_imu;
    addTruth(oxtsPath(packets, path), T_robot_imu.inverse(), drive);
    addSensors(packets, T_robot_imu, drive);
  }
  return drive;
}

OxtsPath oxtsPathFrom(const std::string& name) {
  if (name == "positions") return OxtsPath::kPositions;
  if (name == "velocities") return OxtsPath::kVelocities;
  throw InputError("path '" + name + "' is unknown; known are positions, velocities");
}

std::unique_ptr<Dataset> openKittiRaw(const std::string& folder, const std::string& drive,
                                      OxtsPath path) {
  return std::make_unique<KittiRaw>(
      fs::path(folder) / drive.substr(0, std::string("2011_09_26").size()) / drive, path);
}

}  // namespace headway::io
