// SPDX-License-Identifier: Apache-2.0
#include "core/segmentation/label_table.h"

namespace hardpack {

Status CheckLabelTable(const LabelTable& table) {
  HP_LOOP_BOUND(kLabelCodes)
  for (const ReturnClass meaning : table.class_of) {
    if (static_cast<uint8_t>(meaning) > static_cast<uint8_t>(ReturnClass::kPerson)) {
      return Status::kInvalidArgument;
    }
  }
  return Status::kOk;
}

ReturnClass CheckedLabel(ReturnClass said, const SeenReturn& seen, float obstacle_height_m) {
  if (said == ReturnClass::kIgnored) return seen.what;
  const bool stands_up =
      seen.ground_known && seen.height_m > obstacle_height_m && seen.what != ReturnClass::kIgnored;
  return said == ReturnClass::kGround && stands_up ? ReturnClass::kHard : said;
}

}  // namespace hardpack
