// SPDX-License-Identifier: Apache-2.0
class lower_class {
 public:
  int Get() const { return NoUnderscore; }

 private:
  int NoUnderscore = 0;
};
constexpr int shouting_Constant = 3;
int Planted(int BadParameter) { return BadParameter + shouting_Constant + lower_class().Get(); }
