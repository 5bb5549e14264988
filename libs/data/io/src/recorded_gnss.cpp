// SPDX-License-Identifier: BSD-3-Clause
#include "recorded_gnss.h"

#include <headway/core/mrpt_pose.h>
#include <headway/io/gnss_accuracy.h>
#include <headway/io/mrpt_time.h>
#include <mrpt/obs/gnss_messages_ascii_nmea.h>

#include <array>
#include <cmath>

#include "recorded_poses.h"

namespace headway::io {
namespace {

using mrpt::obs::gnss::Message_NMEA_GGA;

constexpr std::uint32_t kMaxMessages = 100;
constexpr std::size_t kMaxMessageBytes = 1 << 16;
constexpr std::size_t kGgaBytes = sizeof(Message_NMEA_GGA::content_t);
constexpr double kMaxAltitudeM = 1e5;
constexpr double kMaxAntennaOffsetM = 1e3;
constexpr double kDefaultHdop = 1.5;
constexpr double kMaxHdop = 100.0;

/// Standard deviation of a position, both axes together, at a dilution of 1, by NMEA's quality:
/// none, plain, differential, military, fixed and floating ambiguities, dead reckoning.
constexpr std::array<double, 7> kRangeSigmas = {0.0, 3.0, 1.0, 2.0, 0.03, 0.4, 10.0};

void readTimeOfDay(mrpt::obs::gnss::UTC_time& time, ObjectReader& in) {
  time.hour = in.value<std::uint8_t>();
  time.minute = in.value<std::uint8_t>();
  time.sec = in.value<double>();
}

/// The values one by one, because a flag of arbitrary bytes must not become a bool.
Message_NMEA_GGA readGga(ObjectReader& in) {
  Message_NMEA_GGA message;
  auto& fields = message.fields;
  readTimeOfDay(fields.UTCTime, in);
  fields.latitude_degrees = in.value<double>();
  fields.longitude_degrees = in.value<double>();
  fields.fix_quality = in.value<std::uint8_t>();
  fields.altitude_meters = in.value<double>();
  fields.geoidal_distance = in.value<double>();
  fields.orthometric_altitude = in.value<double>();
  fields.corrected_orthometric_altitude = in.value<double>();
  fields.satellitesUsed = in.value<std::uint32_t>();
  fields.thereis_HDOP = in.flag();
  fields.HDOP = in.value<float>();
  return message;
}

/// Standard deviation of each horizontal axis [m] by the covariance (east, north, up), which
/// version 12 may contain.
std::optional<double> readSigma(ObjectReader& in) {
  if (in.text() != "std::optional") throw BrokenObject("a covariance has another type");
  (void)in.text();  // the type of the matrix
  if (!in.flag()) return std::nullopt;
  const auto covariance = in.matrix(3, 3);
  const double variance = 0.5 * (covariance[0] + covariance[4]);
  return variance > 0.0 && std::isfinite(variance) ? std::optional(std::sqrt(variance))
                                                   : std::nullopt;
}

/// States an accuracy as the dilution of precision that gives it.
void setSigma(double sigma_m, Message_NMEA_GGA& message) {
  const auto hdop = hdopOf(message.fields.fix_quality, sigma_m);
  if (!hdop) return;
  message.fields.thereis_HDOP = true;
  message.fields.HDOP = static_cast<float>(*hdop);
}

bool isPosition(const Message_NMEA_GGA::content_t& fields) {
  const bool is_unset = fields.latitude_degrees == 0.0 && fields.longitude_degrees == 0.0;
  return std::abs(fields.latitude_degrees) <= 90.0 && std::abs(fields.longitude_degrees) <= 180.0 &&
         std::abs(fields.altitude_meters) <= kMaxAltitudeM && !is_unset;
}

}  // namespace

mrpt::obs::CObservation::Ptr readGnss(ObjectReader& in) {
  const auto version = in.value<std::uint8_t>();
  if (version < 10 || version > 12) throw UnknownVersion("", version);
  auto observation = mrpt::obs::CObservationGPS::Create();
  observation->timestamp = in.time();
  observation->originalReceivedTimestamp = in.time();
  observation->sensorLabel = in.text();
  observation->sensorPose = readPose3D(in);
  if (version >= 11) observation->has_satellite_timestamp = in.flag();
  const auto sigma = version >= 12 ? readSigma(in) : std::nullopt;
  const auto count = in.value<std::uint32_t>();
  if (count > kMaxMessages) throw BrokenObject("too many messages of a receiver");
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto type = in.value<std::int32_t>();
    const auto bytes = in.value<std::uint32_t>();
    if (bytes > kMaxMessageBytes) throw BrokenObject("a message of a receiver is too long");
    if (type == Message_NMEA_GGA::msg_type && bytes == kGgaBytes) {
      Message_NMEA_GGA message = readGga(in);
      if (sigma) setSigma(*sigma, message);
      observation->setMsg(message);
    } else {
      (void)in.skip(bytes);
    }
  }
  in.leave();
  return observation;
}

std::optional<GnssFix> fixFrom(const mrpt::obs::CObservationGPS& observation,
                               std::map<std::string, std::size_t>& skipped) {
  const auto count = [&skipped](const char* reason) {
    ++skipped[reason];
    return std::nullopt;
  };
  if (!observation.hasMsgClass<Message_NMEA_GGA>()) return count("gnss_no_position");
  const auto& fields = observation.getMsgByClass<Message_NMEA_GGA>().fields;
  const auto hdop =
      fields.thereis_HDOP ? std::optional<double>(static_cast<double>(fields.HDOP)) : std::nullopt;
  const auto sigma = gnssSigma(fields.fix_quality, hdop);
  if (!sigma) return count("gnss_without_fix");
  if (!isPosition(fields)) return count("gnss_no_position");
  GnssFix fix;
  fix.time = timeFrom(observation.timestamp);
  fix.antenna = fromMrpt(observation.sensorPose).translation();
  if (!fix.antenna.allFinite() || fix.antenna.cwiseAbs().maxCoeff() > kMaxAntennaOffsetM) {
    return count("gnss_bad_pose");
  }
  fix.latitude_deg = fields.latitude_degrees;
  fix.longitude_deg = fields.longitude_degrees;
  const bool has_geoid = std::abs(fields.geoidal_distance) <= kMaxAltitudeM;
  fix.altitude_m = fields.altitude_meters + (has_geoid ? fields.geoidal_distance : 0.0);
  fix.sigma_m = *sigma;
  return fix;
}

std::optional<double> gnssSigma(std::uint8_t quality, std::optional<double> hdop) {
  if (quality == 0 || quality >= kRangeSigmas.size()) return std::nullopt;
  if (hdop && *hdop > kMaxHdop) return std::nullopt;
  const bool is_given = hdop && *hdop > 0.0;
  return kRangeSigmas.at(quality) * (is_given ? *hdop : kDefaultHdop) / std::sqrt(2.0);
}

std::optional<double> hdopOf(std::uint8_t quality, double sigma_m) {
  if (quality == 0 || quality >= kRangeSigmas.size()) return std::nullopt;
  return sigma_m * std::sqrt(2.0) / kRangeSigmas.at(quality);
}

}  // namespace headway::io
