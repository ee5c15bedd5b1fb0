#!/bin/sh
# The sources are formatted as .clang-format says; skipped where clang-format is not installed.
#   format.sh SOURCE_ROOT
set -eu

command -v clang-format >/dev/null || exit 77
cd "$1"
# what the program has written stays as it is
find src include components tests -name '*.[ch]' ! -path '*.files/*' -exec clang-format --dry-run -Werror {} +
