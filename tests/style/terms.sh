#!/bin/sh
# A specialist finds a subject by its usual name: the folder with most files that have the term is the one where it is
# treated.
#   terms.sh SOURCE_ROOT
set -eu

cd "$1/src"
bad=0
while IFS=: read -r term folder; do
  [ -n "$term" ] || continue
  found=$(grep -rilE --include='*.[ch]' -e "$term" . | sed 's|^[.]/||; s|/[^/]*$||' | LC_ALL=C sort | uniq -c |
    LC_ALL=C sort -k1,1nr -k2 | awk 'NR == 1 { print $2 }')
  [ "$found" = "$folder" ] || {
    echo "'$term' leads to ${found:-nothing}, not to $folder"
    bad=1
  }
done <<'END'
event location:integrate
dense output:integrate
constraint projection:solve/constraint
coordinate partitioning:solve/constraint
singular configuration:solve/singular
[^a-z_]rank[^_a-z]:solve/constraint
stiffness detection:integrate
error estimate:integrate/implicit
superelement|floating frame:formulate/beam
articulated bod:formulate/recursive
composite bod:formulate/recursive
minimum-norm:solve/constraint
impulse:solve/run
kinematic analysis:solve/run
consistent initial:solve/initial
static equilibrium:solve/initial
END
exit $bad
