# GNU parallel as in docs/clusters.md.
. "$(dirname "$0")/lib.sh"
parallel --version 2>/dev/null | grep -q GNU || skip "GNU parallel is not installed (Debian: parallel)"
begin
trap 'rm -rf "$folder"' EXIT
block sh parallel >commands
[ -s commands ]
HOME=$folder sh -e commands 2>log || { cat log; exit 1; }
check
