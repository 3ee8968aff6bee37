#pragma once
/// Asks GigE Vision cameras over UDP, with deadlines in wall time: Aravis' own questions may take many seconds when
/// nobody answers.

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pickcell/core/result.hpp"
#include "pickcell/frames/gvcp.hpp"

namespace pickcell::frames {

/// A socket towards one camera. One thread at a time.
class GvcpProbe {
 public:
  /// address: IPv4, host byte order.
  explicit GvcpProbe(std::uint32_t address);
  ~GvcpProbe();
  GvcpProbe(const GvcpProbe&) = delete;
  GvcpProbe& operator=(const GvcpProbe&) = delete;

  /// Unset: no answer within the time. Asks once.
  [[nodiscard]] std::optional<gvcp::RegisterAnswer> read(std::uint32_t address, std::chrono::milliseconds timeout);
  [[nodiscard]] std::optional<gvcp::Identity> identify(std::chrono::milliseconds timeout);

 private:
  std::uint32_t address_;
  int socket_ = -1;
  std::uint16_t id_ = 0;
};

/// Every camera that answers a broadcast on any network interface (loopback included) within the time, each once, by
/// address.
[[nodiscard]] std::vector<gvcp::Identity> discover_gige(std::chrono::milliseconds timeout);

/// IPv4 address of a host name or a dotted address.
[[nodiscard]] std::optional<std::uint32_t> resolve(const std::string& host);

}  // namespace pickcell::frames
