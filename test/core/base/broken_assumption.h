// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "core/base/assert.h"

namespace hardpack {

// Runs an action with an assertion hook that leaves it, so that a test can go on after a broken
// assumption. Tests are built with exceptions; core is not, so only code of its headers may be
// left in this way. expression() is empty when nothing was broken.
class BrokenAssumption {
 public:
  template <typename Action>
  explicit BrokenAssumption(Action action) {
    SetAssertionHook([](const char* file, int line, const char* expression) {
      throw Broken{file, line, expression};
    });
    try {
      action();
    } catch (const Broken& broken) {
      broken_ = broken;
    }
    SetAssertionHook(nullptr);
  }

  const std::string& file() const { return broken_.file; }
  int line() const { return broken_.line; }
  const std::string& expression() const { return broken_.expression; }

 private:
  struct Broken {
    std::string file;
    int line = 0;
    std::string expression;
  };
  Broken broken_;
};

}  // namespace hardpack
