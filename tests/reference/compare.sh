#!/bin/sh
# compare.sh: the comparison tool accepts what is right and refuses what is not. COMPARE is the tool.
set -u
: "${COMPARE:?is the comparison tool}"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 2
failed=0

printf 't,x,y\n1,2,0\n2,-4,0\n' >reference.csv
printf '1e-6\n' >tolerance

# expect STATUS NAME: runs the tool on result.csv
expect() {
    "$COMPARE" result.csv reference.csv tolerance >out 2>&1
    status=$?
    [ "$status" -eq "$1" ] && return
    echo "$2: exit status $status, wanted $1"
    cat out
    failed=1
}

printf 't,y,z,x\n0,9,9,9\n1,0,9,2.000003\n2,1e-7,9,-4\n' >result.csv
expect 0 'errors_are_relative_to_the_largest_reference_value'
printf 't,x,y\n1,2.000005,0\n2,-4,0\n' >result.csv
expect 1 'larger_error_is_refused'
printf 't,x,y\n1,2,2e-6\n2,-4,0\n' >result.csv
expect 1 'zero_column_is_measured_against_one'
printf 't,x\n1,2\n2,-4\n' >result.csv
expect 1 'missing_column_is_refused'
printf 't,x,y\n1,2,0\n2.00000001,-4,0\n' >result.csv
expect 1 'missing_time_is_refused'
printf 't,x,y\n1,2,0\n2.0000000001,-4,0\n' >result.csv
expect 0 'time_may_be_rounded'
printf 't,x,y\n1,nan,0\n2,-4,0\n' >result.csv
expect 1 'nan_is_refused'
printf 't,x,y\n1,2\n2,-4,0\n' >result.csv
expect 2 'short_row_is_an_error'
printf 't,x,y\n1,2,\n2,-4,0\n' >result.csv
expect 2 'empty_cell_is_an_error'
printf '"t","x","y"\r\n1,2,0\r\n2,-4,0\r\n' >result.csv
expect 0 'quotes_and_carriage_returns_are_read'
printf '1e-6\nx 1e-2\n' >tolerance
printf 't,x,y\n1,2.005,0\n2,-4,0\n' >result.csv
expect 0 'column_may_have_its_own_tolerance'
printf '1e-6\nx 1e-6 100\n' >tolerance
printf 't,x,y\n1,2.00005,0\n2,-4,0\n' >result.csv
expect 0 'column_may_have_its_own_size'
rm result.csv
expect 2 'missing_file_is_an_error'
exit "$failed"
