#!/bin/sh
# generated.sh: the generated models that are checked in are what their generators write, and meson.build and
# energy.txt leave out no case and no system.
set -u
folder=$(dirname "$0")
systems=$folder/../../systems
failed=0

# same FILE COMMAND...
same() {
    file=$1
    shift
    "$@" | cmp -s - "$file" && return
    echo "$file is not what $* writes"
    failed=1
}

same "$systems/n_four_bar/model.yaml" "$systems/n_four_bar/generate.sh"
same "$systems/chain40/model.yaml" "$systems/chain40/generate.sh"
same "$systems/chain_against_beam/model.yaml" "$systems/chain_against_beam/generate.sh"
same "$systems/spin_up_roberts/model.yaml" "$systems/spin_up_roberts/generate.sh"
same "$systems/spin_up_welded/model.yaml" "$systems/spin_up_welded/generate.sh"
same "$systems/right_angle_frame/model.yaml" "$systems/right_angle_frame/generate.sh"
same "$systems/right_angle_cantilever/model.yaml" "$systems/right_angle_cantilever/generate.sh"
for n in 1 2 3 5 10; do
    same "$folder/R05_N$n.yaml" "$systems/n_four_bar/generate.sh" "$n" 10 1 1e-10
done
same "$folder/R05_N2_20s.yaml" "$systems/n_four_bar/generate.sh" 2 20 1 1e-10
same "$folder/R05_N40.yaml" "$systems/n_four_bar/generate.sh" 40 20 1 1e-9
same "$folder/R12.yaml" "$systems/chain40/generate.sh" 40 5 1 1e-9
same "$folder/R12_pi.yaml" "$systems/chain40/generate.sh" 40 pi pi 1e-9

for file in "$folder"/[RB]*.yaml; do
    case=$(basename "$file" .yaml)
    if grep -q "'$case'" "$folder/meson.build" && [ -f "$folder/$case.reference.csv" ]; then
        [ -f "$folder/$case.tolerance" ] && continue
        grep -q "^$case)" "$folder/converges.sh" && continue
    fi
    echo "$case is not listed in meson.build, or lacks its reference or tolerance"
    failed=1
done
for file in "$systems"/*/model.yaml; do
    system=$(basename "$(dirname "$file")")
    grep -q "^$system " "$folder/energy.txt" && continue
    echo "$system is not in energy.txt"
    failed=1
done
exit "$failed"
