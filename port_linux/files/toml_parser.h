// SPDX-License-Identifier: Apache-2.0
#pragma once

// toml++ 3.3 with a fault mended. Include it by this header only: check_layers.py refuses others.
//
// Its is_non_ascii_horizontal_whitespace has undefined behaviour for U+00A1 to U+0499: they reach a
// default that is marked as unreachable. The parser calls it for every letter of a value that does
// not begin with a quote, such as a = 3"x. Here that mark returns false, which is right: none of
// these letters is a space. In unicode.h only functions that return bool have the mark.

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
