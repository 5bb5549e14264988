// SPDX-License-Identifier: BSD-3-Clause
// Detections as an MRPT observation.
#include <headway/core/detection.h>
#include <headway/core/mrpt_pose.h>
#include <headway/io/detection_observation.h>
#include <headway/io/mrpt_time.h>
#include <mrpt/rtti/CObject.h>
#include <mrpt/serialization/CArchive.h>
#include <mrpt/serialization/optional_serialization.h>

#include <cmath>
#include <cstdio>
#include <ostream>

using mrpt::serialization::CArchive;

namespace headway {

IMPLEMENTS_SERIALIZABLE(CObservationObjectDetections, CObservation, headway)

namespace {

void write(CArchive& out, const Box2d& box) {
  out << box.left << box.top << box.right << box.bottom;
}

void read(CArchive& in, Box2d& box) { in >> box.left >> box.top >> box.right >> box.bottom; }

void write(CArchive& out, const Box3d& box) {
  out << box.centre.x() << box.centre.y() << box.centre.z() << box.length << box.width << box.height
      << box.yaw;
}

void read(CArchive& in, Box3d& box) {
  in >> box.centre.x() >> box.centre.y() >> box.centre.z() >> box.length >> box.width >>
      box.height >> box.yaw;
}

/// Writes the upper triangle, row-major.
void write(CArchive& out, const Eigen::Matrix3d& symmetric) {
  for (int row = 0; row < 3; ++row) {
    for (int column = row; column < 3; ++column) out << symmetric(row, column);
  }
}

void read(CArchive& in, Eigen::Matrix3d& symmetric) {
  for (int row = 0; row < 3; ++row) {
    for (int column = row; column < 3; ++column) {
      in >> symmetric(row, column);
      symmetric(column, row) = symmetric(row, column);
    }
  }
}

template <typename T>
void writeOptional(CArchive& out, const std::optional<T>& value) {
  out << value.has_value();
  if (value) write(out, *value);
}

template <typename T>
void readOptional(CArchive& in, std::optional<T>& value) {
  // Not read as bool, which no byte but 0 and 1 may become.
  const auto flag = in.ReadAs<std::uint8_t>();
  if (flag > 1) THROW_EXCEPTION("broken: a flag is neither 0 nor 1");
  value.reset();
  if (flag == 1) read(in, value.emplace());
}

std::string numbers(std::initializer_list<double> values) {
  std::string text;
  for (const double value : values) {
    char buffer[32];
    std::snprintf(buffer, sizeof(buffer), "%s%.6g", text.empty() ? "" : " ", value);
    text += buffer;
  }
  return text;
}

std::string boxTexts(const CObservationObjectDetections::Item& item) {
  std::string text;
  if (const auto& box = item.box2d) {
    text += " box2d " + numbers({box->left, box->top, box->right, box->bottom});
  }
  if (const auto& box = item.box3d) {
    text += " box3d " + numbers({box->centre.x(), box->centre.y(), box->centre.z(), box->length,
                                 box->width, box->height, box->yaw});
  }
  return text;
}

}  // namespace

uint8_t CObservationObjectDetections::serializeGetVersion() const { return 0; }

void CObservationObjectDetections::serializeTo(CArchive& out) const {
  out << sensorLabel << timestamp << sensor_pose << image_width << image_height;
  out.WriteAs<uint32_t>(items.size());
  for (const auto& item : items) {
    out << item.class_name << item.score << item.detector_id;
    writeOptional(out, item.box2d);
    writeOptional(out, item.box3d);
    writeOptional(out, item.centre_covariance);
  }
}

void CObservationObjectDetections::serializeFrom(CArchive& in, uint8_t version) {
  switch (version) {
    case 0: {
      in >> sensorLabel >> timestamp >> sensor_pose >> image_width >> image_height;
      const auto count = in.ReadAs<uint32_t>();
      items.clear();  // not resized in advance: a corrupt count must not allocate memory
      for (uint32_t i = 0; i < count; ++i) {
        Item item;
        in >> item.class_name >> item.score >> item.detector_id;
        readOptional(in, item.box2d);
        readOptional(in, item.box3d);
        readOptional(in, item.centre_covariance);
        items.push_back(std::move(item));
      }
    } break;
    default:
      MRPT_THROW_UNKNOWN_SERIALIZATION_VERSION(version);
  }
}

void CObservationObjectDetections::getDescriptionAsText(std::ostream& o) const {
  CObservation::getDescriptionAsText(o);
  o << "Sensor pose on the robot: " << sensor_pose << "\nImage: " << image_width << " x "
    << image_height << " px\nDetections: " << items.size() << "\n"
    << "(box2d: left top right bottom [px]; box3d: x y z of the centre, length width height [m], "
       "yaw [rad], optical frame)\n";
  for (const auto& item : items) {
    o << "  " << item.class_name << " score " << item.score << " id " << item.detector_id
      << boxTexts(item) << "\n";
  }
}

std::string CObservationObjectDetections::exportTxtHeader() const {
  return "COUNT {CLASS SCORE ID [box2d LEFT TOP RIGHT BOTTOM] [box3d X Y Z LENGTH WIDTH HEIGHT "
         "YAW]}...";
}

std::string CObservationObjectDetections::exportTxtDataRow() const {
  std::string row = std::to_string(items.size());
  for (const auto& item : items) {
    row += " " + item.class_name + " " + numbers({item.score}) + " " +
           std::to_string(item.detector_id) + boxTexts(item);
  }
  return row;
}

namespace io {

void registerClasses() { mrpt::rtti::registerClass(CLASS_ID(CObservationObjectDetections)); }

CObservationObjectDetections::Ptr observationFrom(const std::string& label,
                                                  const Detections& detections) {
  auto observation = CObservationObjectDetections::Create();
  observation->sensorLabel = label;
  observation->timestamp = mrptTime(detections.time);
  observation->sensor_pose = toMrpt(detections.T_robot_sensor);
  observation->image_width = static_cast<std::uint32_t>(detections.image_width);
  observation->image_height = static_cast<std::uint32_t>(detections.image_height);
  for (const auto& detection : detections.items) {
    observation->items.push_back({std::string(toString(detection.object_class)), detection.score,
                                  detection.detector_id.value_or(-1), detection.box2d,
                                  detection.box3d, detection.centre_covariance});
  }
  return observation;
}

Detections detectionsFrom(const CObservationObjectDetections& observation,
                          std::map<std::string, std::size_t>& dropped) {
  Detections detections;
  detections.time = timeFrom(observation.timestamp);
  detections.T_robot_sensor = fromMrpt(observation.sensor_pose);
  detections.image_width = static_cast<int>(observation.image_width);
  detections.image_height = static_cast<int>(observation.image_height);
  for (const auto& item : observation.items) {
    const auto object_class = objectClassFrom(item.class_name);
    if (!object_class) {
      ++dropped["unknown_class"];
      continue;
    }
    Detection detection;
    detection.object_class = *object_class;
    detection.score = item.score;
    if (item.detector_id >= 0) detection.detector_id = item.detector_id;
    detection.box2d = item.box2d;
    detection.box3d = item.box3d;
    detection.centre_covariance = item.centre_covariance;
    if (!std::isfinite(item.score) || !isPlausible(detection)) {
      ++dropped["implausible_box"];
      continue;
    }
    removeBadCovariance(detection, dropped);
    detections.items.push_back(std::move(detection));
  }
  return detections;
}

}  // namespace io
}  // namespace headway
