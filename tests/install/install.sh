#!/bin/sh
# Install into a folder and use it from there: program, manual page, and the library through pkg-config.
#   install.sh BUILD
set -eu

build=$1
here=$(cd "$(dirname "$0")" && pwd)
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
cd "$place"

fail() {
  echo "install: $*" >&2
  exit 1
}

DESTDIR=$place/root meson install -C "$build" --no-rebuild --quiet >install.log 2>&1 || { cat install.log; fail "meson install"; }
program=$(find root -type f -name cotree -path '*/bin/*')
pc=$(find root -name cotree.pc)
manual=$(find root -name cotree.1 -o -name cotree.1.gz)
[ -n "$program" ] || fail "no program"
[ -n "$pc" ] || fail "no file for pkg-config"
[ -n "$manual" ] || fail "no manual page"
grep -q '^.SS simulate' "$manual" || fail "the manual page has no commands"

for file in bash-completion/completions/cotree.bash zsh/site-functions/_cotree fish/vendor_completions.d/cotree.fish; do
  [ -n "$(find root -path "*/share/$file" -size +1k)" ] || fail "no completion $file"
done

PKG_CONFIG_PATH=$place/$(dirname "$pc")
PKG_CONFIG_SYSROOT_DIR=$place/root
LD_LIBRARY_PATH=$place/$(dirname "$(find root -name 'libcotree.so')")
export PKG_CONFIG_PATH PKG_CONFIG_SYSROOT_DIR LD_LIBRARY_PATH

"$program" --version
# The words of its answer are arguments.
# shellcheck disable=SC2046
${CC:-cc} -std=c99 -Wall -Wextra -Wpedantic -Werror -o user "$here/user.c" $(pkg-config --cflags --libs cotree) -lm
./user "$SYSTEMS/pendulum/model.yaml"
if command -v g++ >/dev/null; then
  # shellcheck disable=SC2046
  g++ -x c++ -Wall -Werror -o user_cc "$here/user.c" -x none $(pkg-config --cflags --libs cotree) -lm
  ./user_cc "$SYSTEMS/pendulum/model.yaml"
fi
