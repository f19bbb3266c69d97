// SPDX-License-Identifier: Apache-2.0
#include "tools/capture/rellis_labels.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "test/tools/capture/capture_files.h"

namespace hardpack::capture {
namespace {

using test::TextFile;

TEST(RellisLabels, FindsColumnsByName) {
  const TextFile file("x,label,meas_id,range_mm,ring\r\n1.5,3,511,7,2\r\n-2.5,17,0,8,15\r\n");
  ScanLabels labels;
  const ReadOutcome outcome = ReadLabels(file.path(), 16, 512, labels);
  ASSERT_TRUE(outcome.ok()) << outcome.message;
  EXPECT_EQ(labels.At(511, 2), 3);
  EXPECT_EQ(labels.At(0, 15), 17);
  EXPECT_EQ(labels.At(0, 14), std::nullopt);
}

TEST(RellisLabels, NamesFileLineAndColumnOfWhatIsWrong) {
  const std::pair<std::string, std::string> cases[] = {
      {"", ": line 1: ring: no such column"},
      {"ring,label\n", ": line 1: meas_id: no such column"},
      {"ring,meas_id,label\n1,2\n", ": line 2: label: missing"},
      {"ring,meas_id,label\n1,2,3\n1,3,x\n", ": line 3: label: not an integer"},
      {"ring,meas_id,label\n1,2,3.5\n", ": line 2: label: not an integer"},
      {"ring,meas_id,label\n1,2,99999999999\n", ": line 2: label: not an integer"},
      {"ring,meas_id,label\n,2,3\n", ": line 2: ring: not an integer"},
      {"ring,meas_id,label\n16,2,3\n", ": line 2: ring: the sensor has no such beam"},
      {"ring,meas_id,label\n-1,2,3\n", ": line 2: ring: the sensor has no such beam"},
      {"ring,meas_id,label\n1,512,3\n", ": line 2: meas_id: the sensor has no such column"},
      {"ring,meas_id,label\n1,2,256\n", ": line 2: label: 256 is not a code from 0 to 255"},
      {"ring,meas_id,label\n1,2,-1\n", ": line 2: label: -1 is not a code from 0 to 255"},
      {"ring,meas_id,label\n1,2,3\n\n1,2,4\n", ": line 4: meas_id: this return is listed twice"},
  };
  for (const auto& [text, message] : cases) {
    const TextFile file(text);
    ScanLabels labels;
    const ReadOutcome outcome = ReadLabels(file.path(), 16, 512, labels);
    EXPECT_EQ(outcome.message, file.path() + message);
    EXPECT_EQ(outcome.status, Status::kInvalidArgument);
  }
  ScanLabels labels;
  EXPECT_EQ(ReadLabels("/nowhere.csv", 16, 512, labels).message,
            "/nowhere.csv: cannot be opened (No such file or directory)");
  EXPECT_EQ(ReadLabels("/dev/zero", 16, 512, labels).status, Status::kOversized);
}

}  // namespace
}  // namespace hardpack::capture
