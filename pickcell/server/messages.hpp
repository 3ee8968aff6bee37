#pragma once
/// What the server says, as JSON: the cell's snapshot, its alarms, the log and the overlay of a picture.

#include <cstdint>
#include <string>
#include <vector>

#include "pickcell/cell/cell_port.hpp"
#include "pickcell/core/json.hpp"
#include "pickcell/core/result.hpp"
#include "pickcell/server/log_tail.hpp"

namespace pickcell::server {

constexpr const char* kProtocol = "cell.v1";

/// {"cell","mode","step","reason","remedy","simulated","robot":{...},"recipe","counters":{...}}: flat, so that a change
/// is sent key by key.
[[nodiscard]] core::Json state_json(const cell::Snapshot& snapshot);

/// Rows with unique ids: the alarm's code, numbered when it occurs more than once.
[[nodiscard]] core::Json::Array alarm_rows(const std::vector<cell::CellAlarm>& alarms);

[[nodiscard]] core::Json log_row(const NumberedEntry& entry);

/// The overlay object of docs/hmi.md with the sensor's size ("sw", "sh") and the reference point ("rx", "ry") added. At
/// most 1000 parts are listed, "more" counts the others.
[[nodiscard]] core::Json overlay_json(const cell::ShownFrame& shown);

/// {"ok":false,"error":{"code","text","remedies":[]}}
[[nodiscard]] core::Json error_json(const core::Error& error);
[[nodiscard]] const char* word(core::ErrorCode code);

}  // namespace pickcell::server
