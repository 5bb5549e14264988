// SPDX-License-Identifier: BSD-3-Clause
// Positions of satellite receivers as recorded, and how accurate they are by what NMEA's GGA
// states.
#include <headway/core/mrpt_pose.h>
#include <headway/io/gnss_fix.h>
#include <headway/io/mrpt_time.h>
#include <headway/io/raw_camera.h>
#include <mrpt/obs/gnss_messages_ascii_nmea.h>

#include <array>
#include <cmath>

namespace headway::io {
namespace {

using mrpt::obs::gnss::Message_NMEA_GGA;

constexpr double kMaxAltitudeM = 1e5;  // of a receiver on a robot
constexpr double kDefaultHdop = 1.5;   // under an open sky
constexpr double kMaxHdop = 100.0;     // above which NMEA receivers state that there is none

/// Standard deviation of a position, both axes together, at a dilution of 1, by NMEA's quality:
/// none, plain, differential, military, fixed and floating ambiguities, dead reckoning.
constexpr std::array<double, 7> kRangeSigmas = {0.0, 3.0, 1.0, 2.0, 0.03, 0.4, 10.0};

bool isPosition(const Message_NMEA_GGA::content_t& fields) {
  const bool is_unset = fields.latitude_degrees == 0.0 && fields.longitude_degrees == 0.0;
  return std::abs(fields.latitude_degrees) <= 90.0 && std::abs(fields.longitude_degrees) <= 180.0 &&
         std::abs(fields.altitude_meters) <= kMaxAltitudeM && !is_unset;
}

}  // namespace

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
  if (!fix.antenna.allFinite() || fix.antenna.cwiseAbs().maxCoeff() > kMaxSensorOffset_m) {
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
