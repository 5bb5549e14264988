#pragma once

#include <Eigen/Core>
#include <array>

namespace headway::objects {

/// Quadratic Bezier curve on the ground plane, eq. (4) of the paper, walked at constant speed.
///
/// The curve's own parameter is not time: at() takes the share of the arc length instead.
class BezierCurve {
 public:
  /// @param start, control, end  [m]
  BezierCurve(const Eigen::Vector2d& start, const Eigen::Vector2d& control,
              const Eigen::Vector2d& end);

  /// Arc length [m].
  [[nodiscard]] double length() const { return length_; }

  /// Place after one share of the arc length, 0 ... 1.
  [[nodiscard]] Eigen::Vector2d at(double share) const {
    const double t = parameterAt(share);
    return start_ + t * (linear_ + t * quadratic_);
  }

  /// Derivative with respect to the curve's parameter there: along the path, not of unit length.
  [[nodiscard]] Eigen::Vector2d tangentAt(double share) const {
    return linear_ + 2.0 * parameterAt(share) * quadratic_;
  }

  /// The curve's parameter at one share of the arc length.
  [[nodiscard]] double parameterAt(double share) const {
    if (!tabulated_) {
      const auto& c = inverse_;
      return share * (c[0] + share * (c[1] + share * (c[2] + share * (c[3] + share * c[4]))));
    }
    return tabulatedParameterAt(share);
  }

 private:
  static constexpr int kTableSize = 32;

  [[nodiscard]] double speedAt(double t) const { return (linear_ + 2.0 * t * quadratic_).norm(); }
  [[nodiscard]] double tabulatedParameterAt(double share) const;
  void fitInverse();
  void tabulate();

  Eigen::Vector2d start_;
  Eigen::Vector2d linear_;
  Eigen::Vector2d quadratic_;
  double length_ = 0.0;
  bool tabulated_ = false;
  std::array<double, 5> inverse_ = {1.0, 0.0, 0.0, 0.0,
                                    0.0};     ///< parameter from share, degree 1 up
  std::array<double, kTableSize + 1> table_;  ///< share of the arc length at t = i / kTableSize
};

}  // namespace headway::objects
