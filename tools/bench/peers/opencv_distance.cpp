// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/peers/opencv_distance.h"

#include <cstdint>
#include <opencv2/core.hpp>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgproc.hpp>

namespace hardpack::peers {
namespace {

std::span<const float> CellsOf(const cv::Mat& distances) {
  return {distances.ptr<float>(), kMapCells};
}

}  // namespace

// An obstacle is a zero of the image: OpenCV measures the distance to those.
struct OpencvDistance::Images {
  static cv::Mat Image(int type) { return {kMapSize_cells, kMapSize_cells, type, cv::Scalar(1)}; }

  cv::Mat hard = Image(CV_8U);
  cv::Mat soft = Image(CV_8U);
  cv::Mat hard_distance = Image(CV_32F);
  cv::Mat soft_distance = Image(CV_32F);
};

OpencvDistance::OpencvDistance() : images_(std::make_unique<Images>()) {
  cv::setNumThreads(1);
}

OpencvDistance::~OpencvDistance() = default;

void OpencvDistance::Load(const Costmap& map) {
  uint8_t* const hard = images_->hard.ptr<uint8_t>();
  uint8_t* const soft = images_->soft.ptr<uint8_t>();
  for (int index = 0; index < kMapCells; ++index) {
    hard[index] = (map.flags[index] & Costmap::kHard) != 0 ? 0 : 255;
    soft[index] = (map.flags[index] & Costmap::kSoft) != 0 ? 0 : 255;
  }
}

void OpencvDistance::Transform() {
  cv::distanceTransform(images_->hard, images_->hard_distance, cv::DIST_L2, cv::DIST_MASK_PRECISE,
                        CV_32F);
  cv::distanceTransform(images_->soft, images_->soft_distance, cv::DIST_L2, cv::DIST_MASK_PRECISE,
                        CV_32F);
}

std::span<const float> OpencvDistance::hard_distance_cells() const {
  return CellsOf(images_->hard_distance);
}

std::span<const float> OpencvDistance::soft_distance_cells() const {
  return CellsOf(images_->soft_distance);
}

}  // namespace hardpack::peers
