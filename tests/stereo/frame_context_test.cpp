// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/stereo/frame_context.h>
#include <headway_test/painted_street.h>

#include <opencv2/core.hpp>

namespace headway::stereo {
namespace {

using test::PaintedStreet;

bool equal(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0.0;
}

TEST(FrameContextTest, MatchingAheadDoesNotChangeTheDisparities) {
  const PaintedStreet street({});
  const FrameContext at_once(street.frame(0));
  const FrameContext ahead(street.frame(0));
  WorkerThread worker;
  ahead.startMatching(worker);
  EXPECT_TRUE(equal(at_once.disparity().values, ahead.disparity().values));
  EXPECT_GT(ahead.disparity().coverage(), 0.2);
}

TEST(FrameContextTest, CopiesShareTheirValues) {
  const PaintedStreet street({});
  const FrameContext context(street.frame(0));
  const FrameContext copy = context;
  EXPECT_EQ(&context.disparity(), &copy.disparity());
  EXPECT_EQ(&context.left(), &copy.left());
  EXPECT_EQ(&context.ground(), &copy.ground());
}

TEST(FrameContextTest, SubtractsTheOffsetWhereThereIsADisparity) {
  const PaintedStreet street({});
  const FrameContext plain(street.frame(0));
  const FrameContext corrected(street.frame(0), DisparityParams(), 0.5, std::nullopt);
  const cv::Mat& before = plain.disparity().values;
  const cv::Mat& after = corrected.disparity().values;
  for (int row = 0; row < before.rows; row += 7) {
    for (int column = 0; column < before.cols; column += 7) {
      const float d = before.at<float>(row, column);
      const float expected = d > 0.0F ? std::max(0.0F, d - 0.5F) : 0.0F;
      EXPECT_FLOAT_EQ(after.at<float>(row, column), expected);
    }
  }
}

TEST(FrontEndTest, CarriesTheGroundFromFrameToFrame) {
  const PaintedStreet street({});
  FrontEnd front_end{DisparityParams()};
  const auto first = front_end.next(street.frame(0), 0.0);
  EXPECT_FALSE(first.lastGround());
  const auto found = first.ground();
  ASSERT_TRUE(found);
  const auto second = front_end.next(street.frame(1), 0.0);
  ASSERT_TRUE(second.lastGround());
  EXPECT_EQ(second.lastGround()->up, found->up);
  const auto third = front_end.next(street.frame(2), 0.0);  // the second's was never searched for
  ASSERT_TRUE(third.lastGround());
  EXPECT_EQ(third.lastGround()->up, found->up);
}

}  // namespace
}  // namespace headway::stereo
