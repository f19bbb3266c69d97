// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "tools/picture/canvas.h"

// What the font libraries keep is not a leak of the pictures: every test ends as the program does.

namespace hardpack::picture {
namespace {

class FontEnvironment : public testing::Environment {
 public:
  void TearDown() override { ReleaseFonts(); }
};

const testing::Environment* const kFonts =
    testing::AddGlobalTestEnvironment(new FontEnvironment);  // GoogleTest deletes it

}  // namespace
}  // namespace hardpack::picture
