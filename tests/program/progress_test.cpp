// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/program/progress.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <thread>

namespace headway::program {
namespace {

TEST(ProgressTest, DurationsAreMinutesAndSeconds) {
  EXPECT_EQ("0:00", durationText(0.2));
  EXPECT_EQ("0:07", durationText(7.4));
  EXPECT_EQ("5:47", durationText(346.9));
  EXPECT_EQ("1:00:00", durationText(3599.6));
  EXPECT_EQ("2:05:46", durationText(7546.0));
  EXPECT_EQ("0:00", durationText(-3.0));
}

TEST(CatchInterruptsTest, SignalsAtOnceAreOneAndALaterOneEndsTheProgram) {
  const auto interruptThrice = [] {
    catchInterrupts();
    for (int i = 0; i < 2; ++i) (void)std::raise(SIGTERM);
    if (!interrupted()) _exit(1);
    std::this_thread::sleep_for(std::chrono::milliseconds(400));
    (void)std::raise(SIGINT);
    _exit(2);
  };
  EXPECT_EXIT(interruptThrice(), testing::ExitedWithCode(130), "");
}

}  // namespace
}  // namespace headway::program
