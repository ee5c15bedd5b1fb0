# Component types with their terminal equations; methods.
. "$(dirname "$0")/lib.sh"
say components
say methods
