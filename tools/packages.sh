#!/usr/bin/env bash
# Which Debian 12 packages each purpose needs, and how they are installed: only what is missing, without questions.
# Sourced by ./start and ./check.

packages_build=(g++ cmake ninja-build libeigen3-dev libexpected-dev nlohmann-json3-dev libtomlplusplus-dev libcli11-dev
  libhwy-dev libpng-dev libjpeg-dev zlib1g-dev libsqlite3-dev libboost-dev)
packages_aravis=(libaravis-dev)  # GigE Vision and USB3 Vision; some 80 MB, so only when it is asked for
# OpenCV's detectors and Ceres, for calibrate (PICKCELL_WITH_CALIBRATION); some 240 MB to fetch and 1 GB on disk, 1 to 2 minutes.
packages_calibration=(libopencv-contrib-dev libceres-dev)
# aravis-tools: the fake camera that ours is judged against
packages_check=("${packages_calibration[@]}" "${packages_aravis[@]}" aravis-tools git python3 ccache libgtest-dev libgmock-dev
  librapidcheck-dev libopencv-core-dev libopencv-imgproc-dev liborocos-kdl-dev clang-format-19)
packages_fuzz=(clang-19 libclang-rt-19-dev)  # the second is only recommended by the first, and holds libFuzzer
# The board's build and its emulator; about 300 MB with what they pull in.
packages_arm64=(g++-aarch64-linux-gnu qemu-user libhwy-dev:arm64 libpng-dev:arm64 libjpeg-dev:arm64 zlib1g-dev:arm64
  libgtest-dev:arm64 libgmock-dev:arm64 librapidcheck-dev:arm64)
packages_hmi=()  # a Node that did not come from Debian's packages is as good
command -v node >/dev/null || packages_hmi+=(nodejs)
command -v npm >/dev/null || packages_hmi+=(npm)
command -v chromium >/dev/null || packages_hmi+=(chromium)

# install_missing NAME...: installs the named packages that are not there yet.
install_missing() {
  local missing=() name
  for name in "$@"; do
    dpkg-query -W -f '${Status}' "$name" 2>/dev/null | grep -q 'ok installed' || missing+=("$name")
  done
  [ ${#missing[@]} -eq 0 ] && return 0
  local as_root=()
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || {
      echo "pickcell: missing packages: ${missing[*]}; install them as root: apt-get install ${missing[*]}" >&2
      return 3
    }
    as_root=(sudo)
  fi
  echo "installing: ${missing[*]}" >&2
  local log
  log=$(mktemp)
  case "${missing[*]}" in *:arm64*) "${as_root[@]}" dpkg --add-architecture arm64 ;; esac
  if ! { "${as_root[@]}" apt-get update -qq && DEBIAN_FRONTEND=noninteractive "${as_root[@]}" apt-get install -y -qq \
    --no-install-recommends "${missing[@]}"; } >"$log" 2>&1; then
    tail -n 20 "$log" >&2
    rm -f "$log"
    echo "pickcell: apt-get could not install ${missing[*]}: see above; check the network and the package sources" >&2
    return 3
  fi
  rm -f "$log"
}
