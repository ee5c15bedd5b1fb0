#!/bin/sh
# No code decides by the name of a component class: a flag or a function of the class says what holds of it, so that a
# new class is treated as its table says. Only the registry looks classes up by name.
#   classes.sh SOURCE_ROOT
set -eu

cd "$1"
bad=0
compare='str(n|case)?cmp *\('
for file in $(find src -name '*.c' ! -path src/component/registry.c | LC_ALL=C sort); do
  if grep -nHE "$compare.*(cls|class)->name|$compare[^;]*edge_kind" "$file"; then
    bad=1
  fi
done
for class in $(cd components && ls -- *.c | sed 's/\.c$//'); do
  # signals have the names of two classes: pin.force, pin.torque
  case $class in force | torque) continue ;; esac
  if grep -rnE "$compare[^;]*\"$class\"" src --include='*.c'; then
    bad=1
  fi
done
[ "$bad" -eq 0 ] || echo 'decide by a flag or a function of the class (src/component/class.h)'
exit $bad
