// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "hal/onboard/control/message_writer.h"
#include "hal/onboard/control/messages.h"

// The body of an area's message. Private to hal/onboard/control.

namespace hardpack::control {

// Of the whole message. Precondition: at most kMaxAreaCorners corners.
size_t AreaBytes(const Area& area);

// A message to be decoded, whose header is good: the statuses of Decode.
Status CheckArea(std::span<const uint8_t> message);
// A command to be encoded.
Status CheckArea(const OperatorCommand& command);

// Precondition of both: CheckArea. Read leaves nothing of the area that was there before.
void ReadArea(std::span<const uint8_t> message, OperatorCommand& command);
void WriteArea(const OperatorCommand& command, MessageWriter& writer);

}  // namespace hardpack::control
