// SPDX-License-Identifier: BSD-3-Clause
// A network that detects objects in single images: its format, its file, and the detector.
#pragma once

#include <headway/core/params.h>
#include <headway/detect/detector.h>

#include <memory>
#include <string>

namespace headway::detect {

/// A network that detects objects in single images, and the format of its output. Section [dnn].
struct NetworkParams {
  enum class Family {
    kYolox,    ///< ONNX; one row a cell: centre and size to decode by cell and stride, then scores
    kDarknet,  ///< .cfg and .weights; rows of centre and size relative to the input, then scores
  };

  Family family = Family::kYolox;
  std::string model = "";      ///< file of the weights: .onnx or .weights; not part of headway
  std::string layout = "";     ///< file of the layers (.cfg); Darknet only
  int input_width_px = 416;    ///< of the network [px], a multiple of 32
  int input_height_px = 416;   ///< [px], a multiple of 32
  double scale = 1.0;          ///< grey values are multiplied by this
  bool swap_red_blue = false;  ///< the network expects RGB
  bool letterbox = true;       ///< keep the image's proportions, fill with `letterbox_grey`
  int letterbox_grey = 114;
  bool tiles = true;             ///< run also on overlapping tiles of wide images
  std::string classes = "coco";  ///< what its classes mean: "coco", or KITTI names by comma
  double min_score = 0.35;       ///< lower scores are left out [-]
  double nms_iou = 0.5;          ///< of two boxes that overlap more the better is kept [-]

  void describe(Params::Section section);
  void validate() const;  ///< @throws InputError
};

/// File of the network's weights: `params.model`, or the first of yolox_nano.onnx and
/// yolox_tiny.onnx in the folders `$HEADWAY_MODELS`, userModels() and /usr/share/headway/models, if
/// the other parameters are those of such a network.
///
/// @return  empty if there is none
[[nodiscard]] std::string findModel(const NetworkParams& params);

/// The user's folder of networks: headway/models below `$XDG_DATA_HOME`, else below
/// `$HOME/.local/share`; empty if neither is set.
[[nodiscard]] std::string userModels();

/// Finds objects by a network, through OpenCV's DNN module. 2D boxes; a StereoLifter adds depth.
/// It runs on the image as a whole and on overlapping tiles of a wide one, whose boxes are joined.
///
/// People on bicycles: a person whose box stands on a bicycle's is one Cyclist; a bicycle without
/// a rider is left out, as nothing that moves by itself.
class NetworkDetector : public Detector {
 public:
  /// @throws InputError naming what was expected if the model cannot be read or does not fit
  explicit NetworkDetector(const NetworkParams& params);
  ~NetworkDetector() override;

  [[nodiscard]] Detections detect(const StereoFrame& frame) override;

  /// The file in use.
  [[nodiscard]] const std::string& model() const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// SHA-256 of a file, as 64 hexadecimal digits.
///
/// @throws InputError if the file cannot be read
[[nodiscard]] std::string sha256OfFile(const std::string& path);

}  // namespace headway::detect
