// SPDX-License-Identifier: BSD-3-Clause
// The programs headway-import and headway-export, run as a user runs them.
extern "C" {
#include <libavformat/avformat.h>
}

#include <gmock/gmock.h>
#include <headway/io/calibration_file.h>
#include <headway/io/dataset.h>
#include <headway/io/rawlog_sink.h>
#include <headway/io/rawlog_source.h>
#include <headway/io/trajectory_file.h>
#include <headway_test/folders.h>
#include <headway_test/paths.h>
#include <mrpt/obs/CObservation.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "processes.h"
#include "synthetic_recording.h"

namespace headway::io {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class ImportExportTest : public ::testing::Test {
 protected:
  test::ProcessResult import(const std::string& arguments) {
    return test::runProcess(std::string(HEADWAY_BIN_DIR) + "/headway-import " + arguments);
  }
  test::ProcessResult exported(const std::string& arguments) {
    return test::runProcess(std::string(HEADWAY_BIN_DIR) + "/headway-export " + arguments);
  }
  /// Folders of walls, grey or in colour, and their calibration, as headway-import images expects.
  std::string imageFolders(int frames, bool colour = false) {
    fs::create_directories(folder_ / "l");
    fs::create_directories(folder_ / "r");
    for (int i = 0; i < frames; ++i) {
      const auto [left, right] = colour ? test::colourWall(i) : test::wall(i);
      cv::imwrite(folder_ / ("l/" + std::to_string(i) + ".png"), left);
      cv::imwrite(folder_ / ("r/" + std::to_string(i) + ".png"), right);
    }
    writeCalibration(folder_ / "c.yaml", test::smallCamera());
    return "images --left " + at("l") + " --right " + at("r") + " --calibration " + at("c.yaml") +
           " -o " + at("x.rawlog") + " ";
  }
  std::string at(const std::string& name) { return folder_ / name; }

  headway::test::TemporaryFolder folder_;
};

TEST_F(ImportExportTest, UsageIsChecked) {
  EXPECT_EQ(2, import("").status);
  EXPECT_EQ(2, import("nuscenes /x -o y").status);
  EXPECT_EQ(2, import("kitti-odometry /x -o y.rawlog").status);  // no sequence
  EXPECT_EQ(0, import("euroc --help").status);
  test::writeContent(folder_ / "d.ini", "[degrade]\n");
  EXPECT_EQ(2, import("euroc /x -o y.rawlog --degrade " + at("d.ini")).status);  // no boxes
  EXPECT_EQ(0, import("--version").status);
  EXPECT_EQ(2, exported("").status);
  EXPECT_EQ(0, exported("kitti-odometry --help").status);
  const auto dump = import("euroc --dump-config");
  EXPECT_EQ(0, dump.status);
  EXPECT_THAT(dump.output, HasSubstr("drop_probability"));
}

TEST_F(ImportExportTest, TheShippedConfigurationIsTheDefault) {
  const std::string shipped = std::string(HEADWAY_SOURCE_DIR) + "/config/degrade.ini";
  EXPECT_EQ(test::contentOf(shipped), import("euroc --dump-config").output)
      << "config/degrade.ini is made by: headway-import euroc --dump-config > config/degrade.ini";
}

TEST_F(ImportExportTest, BadInputIsOneLineAndStatusOne) {
  const auto result = import("kitti-odometry /nowhere --sequence 06 -o " + at("x.rawlog"));
  EXPECT_EQ(1, result.status);
  EXPECT_THAT(result.output, AllOf(HasSubstr("/nowhere/sequences/06"), HasSubstr("\n")));
  EXPECT_EQ(1, std::count(result.output.begin(), result.output.end(), '\n'));
  EXPECT_FALSE(fs::exists(folder_ / "x.rawlog"));
  test::writeContent(folder_ / "broken.rawlog", "rubbish");
  const auto broken = exported("kitti-odometry " + at("broken.rawlog") + " -o " + at("out"));
  EXPECT_EQ(1, broken.status);
  EXPECT_THAT(broken.output, HasSubstr("broken.rawlog: is not a rawlog"));
  EXPECT_FALSE(fs::exists(folder_ / "out"));
}

TEST_F(ImportExportTest, DoesNotOverwriteWithoutTheOption) {
  const std::string call = imageFolders(2);
  test::writeContent(folder_ / "x.rawlog", "precious");
  const auto refused = import(call);
  EXPECT_EQ(1, refused.status);
  EXPECT_THAT(refused.output, HasSubstr("-w overwrites it"));
  EXPECT_EQ("precious", test::contentOf(folder_ / "x.rawlog"));
  EXPECT_EQ(0, import(call + "-w").status);
  EXPECT_EQ(2u, test::framesOf(at("x.rawlog")).size());
  fs::create_directories(folder_ / "out");
  EXPECT_EQ(1, exported("kitti-odometry " + at("x.rawlog") + " -o " + at("out")).status);
  EXPECT_EQ(0, exported("kitti-odometry " + at("x.rawlog") + " -w -q -o " + at("out")).status);
}

TEST_F(ImportExportTest, ImagesOfALongerExportAreRemoved) {
  ASSERT_EQ(0, import(imageFolders(2)).status);
  const std::string call = "kitti-odometry " + at("x.rawlog") + " -q -o " + at("out");
  ASSERT_EQ(0, exported(call).status);
  const fs::path images = folder_ / "out/image_0";
  fs::copy_file(images / "000001.png", images / "000002.png");
  fs::copy_file(images / "000001.png", images / "mine.png");
  ASSERT_EQ(0, exported(call + " -w").status);
  EXPECT_TRUE(fs::exists(images / "000001.png"));
  EXPECT_FALSE(fs::exists(images / "000002.png"));
  EXPECT_TRUE(fs::exists(images / "mine.png"));
}

TEST_F(ImportExportTest, ReportsAnUnwritableOutput) {
  const std::string call = imageFolders(1);
  test::writeContent(folder_ / "file", "");
  const auto result = import(call.substr(0, call.find(" -o")) + " -o " + at("file/x.rawlog"));
  EXPECT_EQ(1, result.status);
  EXPECT_THAT(result.output, HasSubstr("file/x.rawlog"));
  const auto full = import(call.substr(0, call.find(" -o")) + " -w -o /dev/full");
  EXPECT_EQ(1, full.status);
  EXPECT_THAT(full.output, HasSubstr("/dev/full"));
}

TEST_F(ImportExportTest, ColourIsLosslessEmbeddedAndExternal) {
  for (const std::string storage : {"", "--external-images"}) {
    ASSERT_EQ(0, import(imageFolders(2, true) + "-w " + storage).status);
    const auto result = exported("kitti-odometry " + at("x.rawlog") + " -w -o " + at("out"));
    ASSERT_EQ(0, result.status) << result.output;
    for (const auto& [folder, expected] : {std::pair("image_2", test::colourWall(1).left),
                                           std::pair("image_3", test::colourWall(1).right)}) {
      const auto path = folder_ / "out" / folder / "000001.png";
      EXPECT_TRUE(test::sameImage(expected, cv::imread(path, cv::IMREAD_UNCHANGED))) << folder;
    }
    EXPECT_EQ(CV_8UC1, cv::imread(at("out/image_0/000001.png"), cv::IMREAD_UNCHANGED).type());
    EXPECT_FALSE(fs::exists(folder_ / "out/poses.txt"));
  }
  EXPECT_TRUE(fs::exists(folder_ / "x_Images"));
}

TEST_F(ImportExportTest, WritesSideFilesAndDegradedBoxes) {
  test::writeContent(folder_ / "boxes.csv",
                     "frame,class,score,x,y,z,length,width,height,yaw\n"
                     "1,Car,0.9,1,1,20,4,2,1.5,0\n2,Car,0.9,1,1,20,4,2,1.5,0\n1,Unicorn,1,1,1,20,"
                     "4,2,1.5,0\n");
  test::writeContent(folder_ / "poses.tum", "0 0 0 0 0 0 0 1\n0.2 2 0 0 0 0 0 1\n");
  const std::string call = imageFolders(3) + "-w --detections " + at("boxes.csv");
  const auto result = import(call + " --poses " + at("poses.tum"));
  ASSERT_EQ(0, result.status) << result.output;
  EXPECT_THAT(result.output, HasSubstr("unknown_class 1"));
  auto frames = test::framesOf(at("x.rawlog"));
  ASSERT_EQ(3u, frames.size());
  EXPECT_TRUE(frames[0].detections->items.empty());
  EXPECT_EQ(Eigen::Vector3d(1, 1, 20), frames[1].detections->items.at(0).box3d->centre);
  EXPECT_TRUE(frames[1].detections->T_robot_sensor.isApprox(test::smallCamera().T_robot_cam, 1e-9));
  EXPECT_EQ(160, frames[1].detections->image_width);
  EXPECT_NEAR(1.0, frames[1].T_map_robot->translation().x(), 1e-9);

  test::writeContent(folder_ / "degrade.ini", "[degrade]\ndrop_probability = 0\n");
  ASSERT_EQ(0, import(call + " --degrade " + at("degrade.ini")).status);
  frames = test::framesOf(at("x.rawlog"));
  EXPECT_NE(20.0, frames[1].detections->items.at(0).box3d->centre.z());
  // --set wins over the file.
  ASSERT_EQ(
      0, import(call + " --set degrade.drop_probability=1 --degrade " + at("degrade.ini")).status);
  EXPECT_TRUE(test::framesOf(at("x.rawlog")).at(1).detections->items.empty());
  test::writeContent(folder_ / "degrade.ini", "[degrade]\nwind = 3\n");
  const auto unknown_key = import(call + " --degrade " + at("degrade.ini"));
  EXPECT_EQ(1, unknown_key.status);
  EXPECT_THAT(unknown_key.output, AllOf(HasSubstr("degrade.ini"), HasSubstr("wind")));
}

TEST_F(ImportExportTest, ImportsARangeOfFrames) {
  const std::string call = imageFolders(5);
  ASSERT_EQ(0, import(call + "--from-index 1 --to-index 3").status);
  const auto frames = test::framesOf(at("x.rawlog"));
  ASSERT_EQ(3u, frames.size());
  EXPECT_NEAR(0.1, frames[0].time, 1e-9);
  ASSERT_EQ(
      0, exported("kitti-odometry " + at("x.rawlog") + " --from-index 2 -o " + at("out")).status);
  EXPECT_TRUE(test::sameImage(test::wall(3).left,
                              cv::imread(at("out/image_0/000000.png"), cv::IMREAD_UNCHANGED)));
  EXPECT_FALSE(fs::exists(folder_ / "out/image_0/000001.png"));
  EXPECT_EQ(1, import(call + "-w --from-index 9").status);
}

TEST_F(ImportExportTest, KittiSurvivesTheRoundTrip) {
  HEADWAY_REQUIRE_DATA(data);
  const std::string original = data / "kitti_odometry";
  ASSERT_EQ(0, import("kitti-odometry " + original + " --sequence 06 --to-index 15 -q -o " +
                      at("x.rawlog"))
                   .status);
  const auto result =
      exported("kitti-odometry " + at("x.rawlog") + " -o " + at("copy/sequences/06"));
  ASSERT_EQ(0, result.status) << result.output;
  const auto before = openKittiOdometry(original, "06");
  const auto after = openKittiOdometry(at("copy"), "06");
  ASSERT_EQ(51u, before->size());
  ASSERT_EQ(16u, after->size());
  for (std::size_t i = 0; i < after->size(); ++i) {
    const auto a = before->frame(i);
    const auto b = after->frame(i);
    EXPECT_TRUE(test::sameImage(a.left, b.left)) << i;
    EXPECT_TRUE(test::sameImage(a.right, b.right)) << i;
    EXPECT_NEAR(a.time, b.time, 1e-6);
    EXPECT_TRUE(a.truth_T_map_robot->isApprox(*b.truth_T_map_robot, 1e-6)) << i;
  }
  const auto a = readKittiProjections(original + "/sequences/06/calib.txt");
  const auto b = readKittiProjections(at("copy/sequences/06/calib.txt"));
  EXPECT_LT((a.at("P0") - b.at("P0")).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_LT((a.at("P1") - b.at("P1")).cwiseAbs().maxCoeff(), 1e-9);
}

TEST_F(ImportExportTest, EurocIsExportedRectified) {
  HEADWAY_REQUIRE_DATA(data);
  ASSERT_EQ(0, import("euroc " + (data / "euroc/MH_01_easy").string() + " --to-index 4 -q -o " +
                      at("x.rawlog"))
                   .status);
  ASSERT_EQ(0,
            exported("kitti-odometry " + at("x.rawlog") + " -q -o " + at("c/sequences/00")).status);
  ASSERT_EQ(0,
            import("kitti-odometry " + at("c") + " --sequence 00 -q -o " + at("y.rawlog")).status);
  const RawlogSource raw(at("x.rawlog"), {});
  const RawlogSource rectified(at("y.rawlog"), {});
  EXPECT_TRUE(raw.calibration()->rectified_here);
  EXPECT_FALSE(rectified.calibration()->rectified_here);
  EXPECT_LT(raw.calibration()->vertical_disparity_px, 0.4);
  EXPECT_NEAR(0.110, raw.calibration()->baseline_m, 1e-3);
  EXPECT_NEAR(raw.camera()->baseline_m, rectified.camera()->baseline_m, 1e-9);
  EXPECT_EQ(raw.calibration()->median_disparity_px, rectified.calibration()->median_disparity_px);
}

TEST_F(ImportExportTest, KittiTrackingGivesPosesAndBoxes) {
  HEADWAY_REQUIRE_DATA(data);
  ASSERT_EQ(0, import("kitti-tracking " + (data / "kitti_tracking").string() +
                      " --sequence 0001 -q -o " + at("x.rawlog"))
                   .status);
  const auto frames = test::framesOf(at("x.rawlog"));
  ASSERT_EQ(447u, frames.size());
  EXPECT_FALSE(frames[0].stereo);
  EXPECT_GT(frames[0].detections->items.size(), 2u);
  EXPECT_TRUE(frames[0].T_map_robot->isApprox(Pose::Identity(), 1e-9));
  // The car drives forward, and forward is the robot's x.
  EXPECT_GT(frames[50].T_map_robot->translation().x(), 10.0);
  const auto truth = readTruth(at("x.rawlog"));
  EXPECT_EQ(447u, truth.objects.size());
  EXPECT_TRUE(truth.poses.empty());
}

TEST_F(ImportExportTest, KittiRawGivesImagesTruthAndSensors) {
  EXPECT_EQ(0, import("kitti-raw --help").status);
  EXPECT_EQ(2, import("kitti-raw /x -o y.rawlog").status);  // no drive
  HEADWAY_REQUIRE_DATA(data);
  const std::string call = "kitti-raw " + (data / "kitti_raw").string() +
                           " --drive 2011_09_26_drive_0005_sync --to-index 5 -w -o " +
                           at("x.rawlog");
  const auto result = import(call);
  ASSERT_EQ(0, result.status) << result.output;
  EXPECT_THAT(result.output, HasSubstr("6 frames"));
  EXPECT_THAT(result.output, HasSubstr("skipped tracklet_outside_image 14"));
  RawlogSource source(at("x.rawlog"), {});
  const auto frames = test::framesOf(source);
  ASSERT_EQ(6u, frames.size());
  EXPECT_TRUE(frames[0].stereo);
  EXPECT_FALSE(frames[0].T_map_robot);  // SLAM runs
  std::size_t fixes = 0;
  for (const auto& frame : frames) {
    for (const auto& fix : frame.gnss) {
      EXPECT_NEAR(49.01, fix.latitude_deg, 0.01);
      EXPECT_NEAR(0.5, fix.sigma_m, 0.3);
      EXPECT_LE(fix.time, frame.time);
      ++fixes;
    }
  }
  EXPECT_EQ(5u, fixes);  // the sixth is later than the last frame
  EXPECT_NEAR(0.537, source.camera()->baseline_m, 1e-3);
  const auto truth = readTruth(at("x.rawlog"));
  ASSERT_EQ(6u, truth.poses.size());
  EXPECT_EQ(6u, truth.objects.size());
  ASSERT_EQ(0, import(call + " -q --poses oxts --oxts-path velocities").status);
  const auto with_poses = test::framesOf(at("x.rawlog"));
  ASSERT_TRUE(with_poses[5].T_map_robot);
  EXPECT_NEAR(truth.poses[5].value.translation().x(), with_poses[5].T_map_robot->translation().x(),
              0.3);
  EXPECT_THAT(import(call + " --oxts-path speed").output, HasSubstr("known are positions"));
}

TEST_F(ImportExportTest, KittiTrackingWithImagesGivesNoPoses) {
  HEADWAY_REQUIRE_DATA(data);
  const std::string drive = (data / "kitti_raw/2011_09_26/2011_09_26_drive_0005_sync").string();
  const std::string call = "kitti-tracking " + (data / "kitti_tracking").string() +
                           " --sequence 0000 --to-index 3 -q -w -o " + at("x.rawlog");
  ASSERT_EQ(0, import(call + " --images " + drive).status);
  const auto frames = test::framesOf(at("x.rawlog"));
  ASSERT_EQ(4u, frames.size());
  EXPECT_TRUE(frames[3].stereo);
  EXPECT_FALSE(frames[3].T_map_robot);
  EXPECT_FALSE(frames[3].detections);
  EXPECT_EQ(4u, readTruth(at("x.rawlog")).poses.size());
  ASSERT_EQ(0, import(call + " --boxes label_02 --images " + drive).status);
  EXPECT_EQ(3u, test::framesOf(at("x.rawlog"))[3].detections->items.size());
}

/// Writes pairs of a wall, left, right or side by side, as a video at 12.5 frames a second.
void writeVideo(const std::string& path, const char* codec, const std::string& side) {
  const bool is_double = side == "both";
  cv::VideoWriter video(path, cv::VideoWriter::fourcc(codec[0], codec[1], codec[2], codec[3]), 12.5,
                        {is_double ? 320 : 160, 120});
  ASSERT_TRUE(video.isOpened()) << path;
  for (int i = 0; i < 20; ++i) {
    auto [left, right] = test::wall(i);
    cv::Mat image = side == "right" ? right : left;
    if (is_double) cv::hconcat(left, right, image);
    cv::cvtColor(image, image, cv::COLOR_GRAY2BGR);
    video.write(image);
  }
}

TEST_F(ImportExportTest, VideosAreReadWithTheTimesOfTheirContainer) {
  std::ofstream(at("c.yaml")) << "image_size: [160, 120]\nleft: [100, 100, 79.5, 59.5]\n"
                                 "baseline_m: 0.2\n";
  for (const auto& [codec, ending] : {std::pair("MJPG", ".avi"), std::pair("mp4v", ".mp4")}) {
    for (const char* side : {"left", "right", "both"}) writeVideo(at(side) + ending, codec, side);
    for (const std::string& arguments :
         {"--left " + at("left") + ending + " --right " + at("right") + ending,
          "--left " + at("both") + ending + " --side-by-side"}) {
      const auto result = import("images " + arguments + " --calibration " + at("c.yaml") +
                                 " -w -o " + at("x.rawlog"));
      ASSERT_EQ(0, result.status) << result.output;
      EXPECT_THAT(result.output, Not(HasSubstr("times_assumed")));
      RawlogSource source(at("x.rawlog"), {});
      std::size_t frames = 0;
      Time first = 0.0;
      while (const auto frame = source.next()) {
        if (frames == 0) first = frame->time;
        EXPECT_NEAR(0.08 * static_cast<double>(frames), frame->time - first, 1e-3) << arguments;
        const auto wall = test::wall(static_cast<int>(frames++));
        const auto next = test::wall(static_cast<int>(frames));
        const auto difference = [](const cv::Mat& a, const cv::Mat& b) {
          return cv::norm(a, b, cv::NORM_L1);
        };
        EXPECT_LT(difference(frame->stereo->left, wall.left),
                  0.5 * difference(frame->stereo->left, next.left))
            << arguments;
        EXPECT_LT(difference(frame->stereo->right, wall.right),
                  0.5 * difference(frame->stereo->right, next.right))
            << arguments;
      }
      EXPECT_EQ(20u, frames) << arguments;
    }
  }
  std::ofstream(at("no.mp4")) << "this is no video";
  const auto broken = import("images --left " + at("no.mp4") + " --side-by-side --calibration " +
                             at("c.yaml") + " -w -o " + at("x.rawlog"));
  EXPECT_EQ(1, broken.status);
  EXPECT_THAT(broken.output, HasSubstr("no.mp4: is no video that OpenCV can open"));
  std::ofstream(at("no.mp4"))
      << "version https://git-lfs.github.com/spec/v1\noid sha256:1\nsize 9\n";
  EXPECT_THAT(import("images --left " + at("no.mp4") + " --side-by-side --calibration " +
                     at("c.yaml") + " -w -o " + at("x.rawlog"))
                  .output,
              HasSubstr("no.mp4: is a Git-LFS pointer"));
}

/// Copies a video, its image i shown at `timeOf(i)` [s].
void copyWithTimes(const std::string& from, const std::string& to,
                   const std::function<double(int)>& timeOf) {
  AVFormatContext *in = nullptr, *out = nullptr;
  ASSERT_EQ(0, avformat_open_input(&in, from.c_str(), nullptr, nullptr));
  ASSERT_LE(0, avformat_find_stream_info(in, nullptr));
  ASSERT_LE(0, avformat_alloc_output_context2(&out, nullptr, nullptr, to.c_str()));
  AVStream* stream = avformat_new_stream(out, nullptr);
  ASSERT_LE(0, avcodec_parameters_copy(stream->codecpar, in->streams[0]->codecpar));
  stream->codecpar->codec_tag = 0;
  ASSERT_LE(0, avio_open(&out->pb, to.c_str(), AVIO_FLAG_WRITE));
  ASSERT_LE(0, avformat_write_header(out, nullptr));
  AVPacket* packet = av_packet_alloc();
  const auto ticksOf = [&](int i) {
    return std::llround(timeOf(i) * stream->time_base.den / stream->time_base.num);
  };
  for (int i = 0; av_read_frame(in, packet) >= 0; ++i) {
    packet->pts = packet->dts = ticksOf(i);
    packet->duration = ticksOf(i + 1) - ticksOf(i);
    ASSERT_LE(0, av_interleaved_write_frame(out, packet));
  }
  ASSERT_LE(0, av_write_trailer(out));
  av_packet_free(&packet);
  avio_closep(&out->pb);
  avformat_free_context(out);
  avformat_close_input(&in);
}

TEST_F(ImportExportTest, ImagesOfAVideoMayComeAtAnyRate) {
  std::ofstream(at("c.yaml")) << "image_size: [160, 120]\nleft: [100, 100, 79.5, 59.5]\n"
                                 "baseline_m: 0.2\n";
  writeVideo(at("even.mp4"), "mp4v", "both");
  const auto time = [](int i) { return 0.05 * i + 0.004 * i * i; };  // as in ever worse light
  copyWithTimes(at("even.mp4"), at("uneven.mp4"), time);
  const auto result =
      import("images --left " + at("uneven.mp4") + " --side-by-side --calibration " + at("c.yaml") +
             " -o " + at("x.rawlog"));
  ASSERT_EQ(0, result.status) << result.output;
  EXPECT_THAT(result.output, Not(HasSubstr("times_assumed")));
  const auto frames = test::framesOf(at("x.rawlog"));
  ASSERT_EQ(20u, frames.size()) << result.output;
  for (int i = 0; i < 20; ++i) EXPECT_NEAR(time(i), frames[i].time - frames[0].time, 1e-3) << i;
}

TEST_F(ImportExportTest, PairsThatDoNotMatchAreRefusedAsByAReplay) {
  RawlogSource source(std::string(HEADWAY_SOURCE_DIR) + "/rawlogs/hall.rawlog", {});
  const auto frames = test::framesOf(source);
  const StereoCamera& camera = *frames[0].stereo->camera;
  std::ofstream(at("c.yaml")) << "image_size: [" << camera.width << ", " << camera.height
                              << "]\nleft: [" << camera.fx << ", " << camera.fy << ", " << camera.cx
                              << ", " << camera.cy << "]\nbaseline_m: " << camera.baseline_m
                              << "\n";
  for (const char* side : {"l", "r", "other"}) fs::create_directories(folder_ / side);
  for (std::size_t i = 0; i < 20; ++i) {
    const std::string name = "/" + std::to_string(i) + ".png";
    cv::imwrite(at("l") + name, frames[i].stereo->left);
    cv::imwrite(at("r") + name, frames[i].stereo->right);
    cv::imwrite(at("other") + name, frames[frames.size() - 1 - i].stereo->right);
  }
  const auto imported = [&](const std::string& right, const std::string& more) {
    return import("images --rate 10 -w --left " + at("l") + " --right " + at(right) +
                  " --calibration " + at("c.yaml") + " -o " + at("x.rawlog") + more);
  };
  const auto good = imported("r", "");
  EXPECT_EQ(0, good.status) << good.output;
  const auto refused = imported("other", "");
  EXPECT_EQ(1, refused.status);
  EXPECT_THAT(refused.output, HasSubstr("x.rawlog: stereo images: nothing matches"));
  EXPECT_FALSE(std::filesystem::exists(at("x.rawlog"))) << "nothing is left to be replayed";
}

TEST_F(ImportExportTest, CtrlCLeavesAReadableRawlog) {
  HEADWAY_REQUIRE_DATA(data);
  const auto result = test::runProcess(
      std::string(HEADWAY_BIN_DIR) + "/headway-import euroc " +
      (data / "euroc/MH_01_easy").string() + " -o " + at("x.rawlog") +
      " & program=$!; until [ -s " + at(".partial-$program-*-x.rawlog") + " ] || [ -e " +
      at("x.rawlog") + " ]; do sleep 0.01; done; kill -INT $program; wait $program");
  ASSERT_TRUE(fs::exists(folder_ / "x.rawlog")) << result.output;
  RawlogSource source(at("x.rawlog"), {});
  const auto frames = test::framesOf(source).size();
  EXPECT_GT(frames, 0u);
  EXPECT_FALSE(source.truncation());
  EXPECT_THAT(result.output, HasSubstr(std::to_string(frames) + " frames"));
  if (frames < 100) {  // else it was done already
    EXPECT_EQ(130, result.status);
    EXPECT_THAT(result.output, HasSubstr("interrupted"));
  }
}

TEST_F(ImportExportTest, ARawlogIsThinnedToEveryNthFrameWithAllThatOtherSensorsMeasured) {
  {
    RawlogSink sink(at("in.rawlog"), ImageStorage::kEmbedded);
    for (int i = 0; i < 7; ++i) {
      const Time time = test::frameTime(static_cast<std::size_t>(i));
      const auto images = test::colourWall(i);
      sink.writeStereo(time, images.left, images.right, rawFrom(test::smallCamera()));
      Detections detections;
      detections.time = time;
      detections.items.emplace_back().box2d = Box2d{1, 2, 3, 4};
      sink.writeDetections("detections", detections);
      sink.writePose("truth_pose", time, Pose::Identity());
      for (const double delay : {0.02, 0.06}) sink.writeImu(time + delay, {0, 0, 0.1}, {0, 0, 9.8});
    }
  }
  const std::string call = "rawlog " + at("in.rawlog") + " --every 3 -o " + at("x.rawlog");
  const auto result = import(call);
  EXPECT_EQ(0, result.status) << result.output;
  EXPECT_THAT(result.output,
              HasSubstr("x.rawlog: 3 of 7 frames (every 3), 21 observations of other "
                        "sensors\n"));
  const auto before = test::framesOf(at("in.rawlog"));
  const auto frames = test::framesOf(at("x.rawlog"));
  ASSERT_EQ(3u, frames.size());
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(before[3 * i].time, frames[i].time);
    EXPECT_TRUE(test::sameImage(before[3 * i].stereo->left_colour, frames[i].stereo->left_colour));
    EXPECT_TRUE(test::sameImage(before[3 * i].stereo->right, frames[i].stereo->right));
    ASSERT_TRUE(frames[i].detections);
    EXPECT_EQ(1u, frames[i].detections->items.size());
  }
  std::map<std::string, std::size_t> kinds, skipped;
  (void)visitObservations(at("x.rawlog"), skipped, [&](const mrpt::obs::CObservation& observation) {
    ++kinds[observation.sensorLabel];
  });
  EXPECT_EQ(3u, kinds["stereo"]);
  EXPECT_EQ(3u, kinds["detections"]);
  EXPECT_EQ(7u, kinds["truth_pose"]);
  EXPECT_EQ(14u, kinds["imu"]);
  EXPECT_EQ(1, import(call).status);  // it exists
  EXPECT_EQ(0, import(call + " -w -q").status);
}

TEST_F(ImportExportTest, ThinningRefusesWhatItCannotDo) {
  test::recordWalls(at("in.rawlog"), 2);
  const std::string call = "rawlog " + at("in.rawlog") + " -o " + at("x.rawlog");
  EXPECT_EQ(2, import(call).status);  // every what?
  for (const char* every : {"0", "-1", "1.5", "x"}) {
    EXPECT_EQ(2, import(call + " --every " + every).status) << every;
  }
  EXPECT_EQ(1, import("rawlog " + at("in.rawlog") + " -w --every 2 -o " + at("in.rawlog")).status);
  test::recordWalls(at("beside.rawlog"), 2, ImageStorage::kExternalPng);
  const auto beside = import("rawlog " + at("beside.rawlog") + " --every 2 -o " + at("x.rawlog"));
  EXPECT_EQ(1, beside.status);
  EXPECT_THAT(beside.output, HasSubstr("beside.rawlog: stores its images beside it"));
  EXPECT_FALSE(fs::exists(folder_ / "x.rawlog"));
}

}  // namespace
}  // namespace headway::io
