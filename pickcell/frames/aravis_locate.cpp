#include "pickcell/frames/aravis_locate.hpp"

#include <arv.h>

#include <algorithm>
#include <mutex>
#include <vector>

#include "pickcell/frames/aravis_device.hpp"
#include "pickcell/frames/gvcp_probe.hpp"

namespace pickcell::frames {

using core::ErrorCode;
using core::failure;
using std::chrono::milliseconds;

namespace {

constexpr milliseconds kSearch{400}, kAnswer{150};
constexpr int kAsks = 3;

bool held(GvcpProbe& probe) {
  for (int i = 0; i < kAsks; ++i)
    if (const auto control = probe.read(gvcp::kControlRegister, kAnswer))
      return control->status == 0 && (control->value & gvcp::kHeldBits) != 0;
  return false;
}

/// ", by the program at ADDRESS:PORT" where the camera tells.
std::string holder(GvcpProbe& probe) {
  const auto address = probe.read(gvcp::kControllerAddressRegister, kAnswer);
  const auto port = probe.read(gvcp::kControllerPortRegister, kAnswer);
  if (!address || address->value == 0) return {};
  return " (at " + gvcp::dotted(address->value) + (port ? ":" + std::to_string(port->value) : "") + ")";
}

std::string full_name(const gvcp::Identity& i) { return i.vendor + "-" + i.model + "-" + i.serial; }

bool is_called(const gvcp::Identity& i, const std::string& name) {
  return name.empty() || name == i.serial || name == i.user_name || name == i.mac || name == full_name(i) ||
         name == i.vendor + "-" + i.serial || name == gvcp::dotted(i.address);
}

std::optional<gvcp::Identity> identify(GvcpProbe& probe) {
  for (int i = 0; i < kAsks; ++i)
    if (auto answer = probe.identify(kAnswer)) return answer;
  return std::nullopt;
}

core::Result<Located> located(const gvcp::Identity& i) {
  GvcpProbe probe(i.address);
  const std::string shown = full_name(i) + " at " + gvcp::dotted(i.address);
  if (held(probe)) {
    const auto timeout = probe.read(gvcp::kHeartbeatTimeoutRegister, kAnswer);
    const std::string seconds = timeout ? std::to_string((timeout->value + 999) / 1000) : "some";
    return failure(ErrorCode::device, shown, "another program holds the camera" + holder(probe),
                   "close it there; if it crashed, the camera is free again after " + seconds + " s");
  }
  return Located{gvcp::dotted(i.address), i.address, shown};
}

/// Aravis' list of devices is one for the whole process.
std::mutex& list_mutex() {
  static std::mutex mutex;
  return mutex;
}

std::string text(const char* s) { return s == nullptr ? "" : s; }

std::vector<ListedCamera> usb3_cameras() {
  const std::lock_guard lock(list_mutex());
  arv_disable_interface("GigEVision");  // asked by ourselves, with deadlines
  arv_update_device_list();
  std::vector<ListedCamera> out;
  for (unsigned i = 0; i < arv_get_n_devices(); ++i) {
    if (text(arv_get_device_protocol(i)) != "USB3Vision") continue;
    out.push_back({"aravis:" + text(arv_get_device_id(i)), "USB3 Vision", text(arv_get_device_vendor(i)),
                   text(arv_get_device_model(i)), text(arv_get_device_serial_nbr(i)), text(arv_get_device_address(i)),
                   "", false});
  }
  arv_enable_interface("GigEVision");
  return out;
}

/// others: cameras that are there but not meant.
core::Result<Located> choose(const std::string& name, const std::vector<gvcp::Identity>& gige,
                             const std::vector<ListedCamera>& usb, const std::string& others) {
  const std::string what = "aravis:" + name;
  if (gige.size() + usb.size() > 1) {
    std::string all;
    for (const auto& g : gige) all += (all.empty() ? "" : ", ") + full_name(g);
    for (const auto& u : usb) all += (all.empty() ? "" : ", ") + u.source.substr(7);
    return failure(ErrorCode::device, what, "several cameras are meant: " + all, "name one of them");
  }
  if (!gige.empty()) return located(gige.front());
  if (!usb.empty()) {
    const std::string id = usb.front().source.substr(7);
    return Located{id, std::nullopt, id + " on USB"};
  }
  if (!others.empty())
    return failure(ErrorCode::device, what, "no camera of that name answers; there is " + others,
                   "name one of these, or check power and cable of the other");
  return failure(ErrorCode::device, what, name.empty() ? "no camera found" : "no camera of that name answers",
                 "check power and cable; `pickcell camera list` shows what there is");
}

}  // namespace

core::Result<Located> locate_aravis(const std::string& name) {
  const bool may_be_host = name.find('.') != std::string::npos || name == "localhost";
  if (may_be_host) {
    if (const auto address = resolve(name)) {
      GvcpProbe probe(*address);
      if (const auto identity = identify(probe)) return located(*identity);
      return failure(ErrorCode::device, "aravis:" + name, "nobody answers at " + gvcp::dotted(*address),
                     "check power, cable and address; `pickcell camera list` shows what there is");
    }
  }
  auto gige = discover_gige(kSearch);
  std::string others;
  const auto is_other = [&](bool other, const std::string& called) {
    if (other) others += (others.empty() ? "" : ", ") + called;
    return other;
  };
  std::erase_if(gige, [&](const auto& i) { return is_other(!is_called(i, name), full_name(i)); });
  std::vector<ListedCamera> usb;
  if (name.empty() || gige.empty()) {
    usb = usb3_cameras();
    std::erase_if(usb, [&](const auto& u) {
      return is_other(!name.empty() && name != u.serial && "aravis:" + name != u.source, u.source.substr(7));
    });
  }
  return choose(name, gige, usb, others);
}

std::vector<ListedCamera> find_aravis_cameras() {
  std::vector<ListedCamera> out;
  for (const gvcp::Identity& i : discover_gige(kSearch)) {
    GvcpProbe probe(i.address);
    out.push_back({"aravis:" + full_name(i), "GigE Vision", i.vendor, i.model, i.serial, gvcp::dotted(i.address),
                   i.user_name, held(probe)});
  }
  for (ListedCamera& u : usb3_cameras()) out.push_back(std::move(u));
  return out;
}

}  // namespace pickcell::frames
