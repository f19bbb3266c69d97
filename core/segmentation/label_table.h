// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/base/loop_bound.h"
#include "core/base/status.h"
#include "core/measurements/measurements.h"

// The meaning of a segmentation's codes for driving ([OS] Cost Map Creation; docs/algorithm.md
// section 1). The default ontology is RELLIS-3D's; the split into hard, soft, person, ground and
// ignored is ours. A code that the table does not name is hard: when in doubt, hard.

namespace hardpack {

inline constexpr int kLabelCodes = 256;

struct LabelTable {
  ReturnClass class_of[kLabelCodes] = {};  // [code]
};

// RELLIS-3D: hard 4 tree, 5 pole, 6 water, 8 vehicle, 9 object, 12 building, 15 log, 18 fence,
// 27 barrier, 34 rubble; person 17; soft 19 bush, 31 puddle, 33 mud; ground 1 dirt, 3 grass,
// 10 asphalt, 23 concrete; ignored 0 void, 7 sky. Every other code is hard.
constexpr LabelTable RellisLabelTable() {
  LabelTable table;
  HP_LOOP_BOUND(kLabelCodes)
  for (ReturnClass& meaning : table.class_of) meaning = ReturnClass::kHard;
  constexpr uint8_t kSoft[] = {19, 31, 33};
  constexpr uint8_t kGround[] = {1, 3, 10, 23};
  constexpr uint8_t kIgnored[] = {0, 7};
  HP_LOOP_BOUND(3)
  for (const uint8_t code : kSoft) table.class_of[code] = ReturnClass::kSoft;
  HP_LOOP_BOUND(4)
  for (const uint8_t code : kGround) table.class_of[code] = ReturnClass::kGround;
  HP_LOOP_BOUND(2)
  for (const uint8_t code : kIgnored) table.class_of[code] = ReturnClass::kIgnored;
  table.class_of[17] = ReturnClass::kPerson;
  return table;
}

// kInvalidArgument: an entry that is not a ReturnClass. Cost: kLabelCodes.
Status CheckLabelTable(const LabelTable& table);

// A return as classed by geometry.
struct SeenReturn {
  ReturnClass what = ReturnClass::kIgnored;
  float height_m = 0.0f;  // above the local ground, where it is known
  bool ground_known = false;
};

// The class with which a labelled return is filed: its label, but no label lowers what geometry
// saw. A return labelled as ground that stands more than obstacle_height_m above the local ground
// is hard, unless geometry takes it for rain or dust; where the ground is not known, the label
// stands. A return labelled as nothing (void, sky) keeps its geometric class.
ReturnClass CheckedLabel(ReturnClass said, const SeenReturn& seen, float obstacle_height_m);

}  // namespace hardpack
