// SPDX-License-Identifier: Apache-2.0
#pragma once

// toml++ 3.3 as this project uses it; the only place that includes it.
//
// Its is_non_ascii_horizontal_whitespace is undefined for U+00A1 to U+0499, none of which is a
// space: the default of its last switch is marked as unreachable. The parser asks it for every
// letter of a value that has begun without a quote, such as a = 3"x. Here the mark is an answer;
// all functions of unicode.h with the mark return bool.

// The library's names for its options.
#define TOML_EXCEPTIONS 0         // NOLINT(readability-identifier-naming)
#define TOML_MAX_NESTED_VALUES 4  // NOLINT(readability-identifier-naming)

// clang-format off: the order is what this is about
#include <toml++/impl/forward_declarations.h>
#pragma push_macro("TOML_UNREACHABLE")
#undef TOML_UNREACHABLE
#define TOML_UNREACHABLE return false  // NOLINT(readability-identifier-naming)
#include <toml++/impl/unicode.h>
#pragma pop_macro("TOML_UNREACHABLE")
#include <toml++/toml.h>
// clang-format on
