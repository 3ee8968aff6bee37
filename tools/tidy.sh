#!/usr/bin/env bash
# clang-tidy over the changed files (or the ones named): names, bug patterns, needless copies. Needs clang-tidy-19 and a
# configured dev build.
set -euo pipefail
cd "$(dirname "$0")/.."
. tools/packages.sh
install_missing clang-tidy-19
cmake --preset dev -DCMAKE_EXPORT_COMPILE_COMMANDS=ON >/dev/null
files=("$@")
[ ${#files[@]} -gt 0 ] || mapfile -t files < <(git ls-files 'pickcell/*.cpp' | grep -v _test)
printf '%s\n' "${files[@]}" | xargs -P "$(nproc)" -n 4 clang-tidy-19 -p build/dev --quiet 2>/dev/null
