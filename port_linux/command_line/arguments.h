// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

// Option values that are more than one word for CLI11: lists of numbers, an output folder. All
// throw a CommandFailure (bad input) that names the option.

namespace hardpack::command {

// "2.5,-3" -> {2.5, -3}: between `least` and `most` finite numbers of at most 1e6, comma-separated,
// nothing else. `form` is the form given in the option's help, "X,Y[,THETA]".
std::vector<float> ParseNumbers(const std::string& option, const std::string& text, size_t least,
                                size_t most, const std::string& form);

// One finite number, the whole of the text.
double ParseNumber(const std::string& option, const std::string& text);

// Creates the folder and its parents if they are missing.
void MakeOutputFolder(const std::string& path);

void WriteText(const std::string& path, const std::string& text);

// A float for JSON: the shortest digits that give the same float again, not the 17 of its value as
// a double. null if it is not finite.
nlohmann::json JsonNumber(float value);

}  // namespace hardpack::command
