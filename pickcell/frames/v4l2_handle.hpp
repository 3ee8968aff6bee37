#pragma once
/// An open /dev/videoN and the questions put to it; shared by the files v4l2_*.cpp alone.

#include <optional>
#include <string>
#include <vector>

#include "pickcell/core/result.hpp"
#include "pickcell/frames/camera_settings.hpp"
#include "pickcell/frames/v4l2_data.hpp"

namespace pickcell::frames::v4l2 {

class Handle {
 public:
  [[nodiscard]] static core::Result<Handle> open(const std::string& path);
  Handle(Handle&& other) noexcept;
  Handle& operator=(Handle&&) = delete;
  ~Handle();

  [[nodiscard]] int fd() const { return fd_; }
  [[nodiscard]] const std::string& path() const { return path_; }
  /// ioctl, repeated when a signal interrupts it; errno stays.
  [[nodiscard]] bool ask(unsigned long request, void* data) const;
  /// errno as an error: busy, gone, refused.
  [[nodiscard]] core::Error error(const std::string& doing) const;

  [[nodiscard]] std::optional<Capability> capability() const;
  [[nodiscard]] std::vector<FormatName> formats() const;
  [[nodiscard]] std::vector<Control> controls() const;
  [[nodiscard]] std::optional<std::int64_t> value(const Control& control) const;
  [[nodiscard]] core::Status set(const Control& control, std::int64_t value) const;

  /// The layout that the driver agreed to, after all settings are made.
  [[nodiscard]] core::Result<Layout> apply(const CameraSettings& settings) const;

 private:
  Handle(int fd, std::string path);
  [[nodiscard]] core::Result<std::uint32_t> choose_format(const std::string& wanted) const;
  [[nodiscard]] core::Result<Layout> set_layout(const CameraSettings& settings) const;
  [[nodiscard]] core::Status set_controls(const CameraSettings& settings) const;
  [[nodiscard]] core::Status set_named(const std::vector<Control>& all, const std::string& key,
                                       const std::string& value) const;
  [[nodiscard]] core::Status set_rate(double fps) const;

  int fd_ = -1;
  std::string path_;
};

/// Exposure controls of V4L2 count in 100 us.
[[nodiscard]] std::optional<double> exposure_us(const Handle& handle);
[[nodiscard]] std::optional<double> gain(const Handle& handle);

}  // namespace pickcell::frames::v4l2
