#!/bin/sh
# accuracy.sh [SECTION...]: makes the tables of docs/accuracy.md between <!-- SECTION --> and <!-- /SECTION --> anew, all of them if
# none is named, and the figures in docs/figures, from runs of the program. Each section goes to the page when it is
# complete; one that fails leaves the page as it is. COTREE is the program.
# shellcheck disable=SC2317 # sections are called by their names
set -eu
docs=$(cd "$(dirname "$0")" && pwd)
root=$docs/..
reference=$root/tests/reference
page=$docs/accuracy.md
: "${COTREE:?is the program}"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
trap 'exit 1' HUP INT TERM

# ---- one run -------------------------------------------------------------------------------------

# run MODEL OPTION...: result.csv and summary.json in $work; how it failed in error.txt
run() {
    model=$1
    shift
    rm -f "$work/result.csv" "$work/summary.json"
    "$COTREE" simulate "$model" -o "$work/result.csv" --quiet --summary "$work/summary.json" "$@" 2>"$work/error.txt"
}

# value KEY: a number or word of summary.json
value() {
    sed -n "s/^ *\"$1\": \"\{0,1\}\([^\",]*\)\"\{0,1\},\{0,1\}\$/\1/p" "$work/summary.json" | head -n 1
}

# error_against REFERENCE.csv [LEAST]: the largest error over its columns and times, each column against its largest value in
# the run; energies and momenta whose exact value is zero are left out, and errors of LEAST and less by themselves.
error_against() {
    awk -F, -v least="${2:-0}" '
        function size(x) { return x < 0 ? -x : x }
        FNR == 1 { nfile++ }
        nfile == 1 && FNR == 1 { for (i = 1; i <= NF; i++) column[i] = $i; n = NF; next }
        nfile == 1 { rows++; for (i = 1; i <= n; i++) want[rows, column[i]] = $i + 0; next }
        FNR == 1 { for (i = 1; i <= NF; i++) of[$i] = i; next }
        {
            for (i = 2; i <= n; i++) {
                v = size($(of[column[i]]))
                if (v > largest[i]) largest[i] = v
            }
            for (r = 1; r <= rows; r++)
                if (size($1 - want[r, "t"]) < 1e-9)
                    for (i = 2; i <= n; i++) {
                        d = size($(of[column[i]]) - want[r, column[i]])
                        if (d > worst[i]) worst[i] = d
                        if (size(want[r, column[i]]) > exact[i]) exact[i] = size(want[r, column[i]])
                    }
        }
        END {
            for (i = 2; i <= n; i++)
                if (exact[i] > 1e-12 && worst[i] > least && worst[i] / largest[i] > error) error = worst[i] / largest[i]
            printf "%.1e\n", error
        }' "$1" "$work/result.csv"
}

# ---- what is asked for, what is achieved -------------------------------------------------------------

title() {
    case $1 in
    R01) echo "Andrews' mechanism, 0.03 s" ;;
    R02) echo "Andrews' mechanism (A03), 0.05 s" ;;
    R04) echo "pendulum (A01), 10 s" ;;
    R05_N1) echo "one four-bar (A02), 10 s" ;;
    R05_N2) echo "two four-bars, 10 s" ;;
    R05_N5) echo "five four-bars, 10 s" ;;
    R05_N10) echo "ten four-bars, 10 s" ;;
    R05_N40) echo "forty four-bars, 20 s" ;;
    R06_brick) echo "Bricard mechanism (A04), 10 s" ;;
    R06_slender) echo "the same, thin rods" ;;
    R07_H) echo "spatial slider-crank, 5 s" ;;
    R07_E) echo "the same, crank not balanced" ;;
    R08a) echo "heavy top, 10 s" ;;
    R08b) echo "top through the vertical, 10 s" ;;
    R12) echo "chain of 40 links, 5 s" ;;
    R13_d1) echo "parallelogram, bars collinear, 20 s" ;;
    R13_d0999) echo "nearly a parallelogram, 4 s" ;;
    R13_d099_10s) echo "near a parallelogram, 10 s" ;;
    R14_k1e4) echo "spring pendulum, 1e4 N/m, 10 s" ;;
    R14_k1e6) echo "spring pendulum, 1e6 N/m, 10 s" ;;
    R15_M1e-3) echo "light cart, 1 g, 10 s" ;;
    H_light_cart) echo "light cart (absolute), 1 mg, 10 s" ;;
    R15_M1e-6) echo "light cart, 1 mg, 10 s" ;;
    R16) echo "six-axis arm, 2 s" ;;
    R04_2000s) echo "pendulum, 2000 s" ;;
    R05_N2_20s) echo "two four-bars, 20 s" ;;
    R16_5s) echo "six-axis arm, 5 s" ;;
    R17a) echo "double pendulum, 10 s" ;;
    R17a_20s) echo "double pendulum, 20 s" ;;
    R17b) echo "double pendulum, middle mass 1 mg, 2 s" ;;
    H_bricard_100s) echo "Bricard mechanism, 100 s" ;;
    H_tumbling_100s) echo "turning over about the middle axis, 100 s" ;;
    H_governor) echo "stiff flyball governor (A05), 10 s" ;;
    H_heavy_first) echo "double pendulum, second mass 1e-8, 10 s" ;;
    H_light_first) echo "double pendulum, first mass 1e-8, 0.5 s" ;;
    H_stiff_limit) echo "spring pendulum, 1e12 N/m, 5 s" ;;
    H_double_1000s) echo "double pendulum, 1000 s" ;;
    *) sed -n 's/^name: *//p' "$reference/$1.yaml" ;;
    esac
}

# cases LETTER...: the cases of tests/reference that begin with one of them, but for those
# - whose references are those of other models, the exact beam, a finer mesh, a linear theory: what differs is no error of a run,
# - that are not integrated but ask for forces at one instant,
# - that are lost: the last bit of g moves the rates of R17b_5s by 3e-2 (tests/reference/README.md).
cases() {
    for letter in "$@"; do
        for file in "$reference/$letter"*.yaml; do
            case=${file##*/}
            case=${case%.yaml}
            case $case in
            R03* | R09_* | R10* | R11_* | B09 | B12_* | B13_*) ;;
            R16_start | R16_hold | R16_moving) ;;
            R17b_5s) ;;
            *) [ ! -f "$reference/$case.reference.csv" ] || echo "$case" ;;
            esac
        done
    done
}

# changed_model PART: the model of $case with a number larger by this part, or by the last bit for PART 0: its gravity or, if it has
# none, the first parameter, stiffness, mass or length
changed_model() {
    awk -v part="$1" '
        function changed(text,    x, i) {
            x = text * (1 + part)
            for (i = 1; part == 0 && x == text + 0; i *= 2) x = text * (1 + i * 1.1102230246251565e-16)
            return sprintf("%.17g", x)
        }
        # in the line, the number that ends what `pattern` matches
        function change(pattern,    text, number) {
            if (done || !match($0, pattern)) return
            text = substr($0, RSTART, RLENGTH)
            number = text
            sub(/^.*[^-+.0-9e]/, "", number)
            $0 = substr($0, 1, RSTART + length(text) - length(number) - 1) changed(number) substr($0, RSTART + RLENGTH)
            done = 1
        }
        NR == FNR { if (/9\.81([^0-9]|$)/) gravity = 1; if (/^parameters:/) parameters = 1; next }
        gravity { change("9\\.81") }
        /^parameters:/ { inside = 1 }
        !gravity && inside { change(": *[1-9][.0-9]*(e[-+]?[0-9]+)?") }
        !gravity && !parameters { change("[{ ](E|mass|stiffness|length): *[1-9][.0-9]*(e[-+]?[0-9]+)?") }
        { print }
        END { exit !done }' "$reference/$case.yaml" "$reference/$case.yaml" >"$work/changed.yaml"
}

# is_less X Y FACTOR: X < FACTOR Y
is_less() {
    awk -v x="$1" -v y="$2" -v factor="$3" 'BEGIN { exit !(x < factor * y) }'
}

# moves PART: how far outputs of $case move at tolerance T if its data change by that part
moves() {
    if changed_model "$1" && run "$work/changed.yaml" --method auto --tolerance "$T"; then
        error_against "$work/as_it_is.csv"
    else
        echo 0
    fi
}

# left: what a hundredth of T leaves of the error of $case
left() {
    if run "$reference/$case.yaml" --method auto --tolerance "$(awk -v T="$T" 'BEGIN { print T/100 }')"; then
        error_against "$reference/$case.reference.csv"
    else
        echo 0
    fi
}

# reason ERROR: why the run of $case in $work/as_it_is.csv at tolerance T errs by more than 10 T:
# a: the output is so small that the error is less than absolute, T/100,
# r: the reference, where it has twelve digits (the errors that --verify estimates are less than 10 T),
# c: what the motion does to any error (a change of a number of the model by its part T moves the outputs by a tenth of the
# error or more, and by ten times T), b: double precision (the last bit of that number moves them by a third of the error, and a
# hundredth of T leaves a third of it)
reason() {
    small=$(error_against "$reference/$case.reference.csv" "$(awk -v T="$T" 'BEGIN { print T/100 }')")
    if is_less "$small" "$T" 10; then
        echo " a"
        return
    fi
    case $case in
    B*)
        if run "$reference/$case.yaml" --method auto --tolerance "$T" --verify && is_less "$(value global)" "$T" 10; then
            echo " r"
            return
        fi
        ;;
    esac
    part=$(moves "$T")
    why=
    if is_less "$1" "$part" 10 && ! is_less "$part" "$T" 10; then why=" c"; fi
    if is_less "$1" "$(moves 0)" 3 && is_less "$1" "$(left)" 3; then why="$why b"; fi
    echo "${why:- **?**}"
}

# row CASE: its line of the table
row() {
    case=$1
    case $case in
    B*) line="| $case" ;; # the page says what the parts of these names mean
    *) line="| $(title "$case") ($case)" ;;
    esac
    methods=
    for T in 1e-4 1e-6 1e-8 1e-10; do
        if run "$reference/$case.yaml" --method auto --tolerance $T; then
            error=$(error_against "$reference/$case.reference.csv")
            method=$(value method)
            case " $methods " in *" $method "*) ;; *) methods="$methods${methods:+ }$method" ;; esac
            cp "$work/result.csv" "$work/as_it_is.csv"
            is_less "$error" $T 10 || error=$error$(reason "$error")
            line="$line | $error"
        else
            line="$line | fails"
        fi
    done
    echo "$line | $(echo "$methods" | sed 's/ /, /g') |"
}

# rows LETTER...: those of all its cases, made side by side: no times are measured
rows() {
    echo "| case | 1e-4 | 1e-6 | 1e-8 | 1e-10 | method |"
    echo "| --- | --- | --- | --- | --- | --- |"
    rm -rf "$work/rows"
    mkdir "$work/rows"
    cases "$@" >"$work/cases"
    COTREE=$COTREE ROWS=$work/rows xargs -n 1 -P "$(nproc 2>/dev/null || echo 1)" sh "$docs/accuracy.sh" --row <"$work/cases"
    while read -r case; do cat "$work/rows/$case"; done <"$work/cases"
}

section_asked() {
    rows R turns isosceles damped_chain chain_ends pulse stretched
}

section_asked_beams() {
    rows B
}

# ---- hard cases -----------------------------------------------------------------------------------------

# hard_row TITLE REFERENCE MODEL OPTION...: REFERENCE may be empty
hard_row() {
    what=$1 against=$2
    shift 2
    run "$@" --verify || { echo "| $what | fails: $(head -n 1 "$work/error.txt") | | | | | | | |"; return; }
    error=
    [ -z "$against" ] || error=$(error_against "$against")
    awk -v what="$what" -v error="$error" -v global="$(value global)" -v drift="$(value energy_drift)" \
        -v position="$(value position_constraint)" -v T="$(value tolerance)" -v method="$(value method)" \
        -v steps="$(value steps)" -v evaluations="$(value evaluations)" -v seconds="$(value integrate)" '
        BEGIN {
            printf "| %s | %g | %s | %.1e | %.1e | %s | %s | %d | %d | %.2g |\n", what, T, error, global, drift,
                (position > 0 ? sprintf("%.0e", position) : ""), method, steps, evaluations, seconds
        }'
}

section_hard() {
    echo "| case | T | error | estimated | energy drift | constraints | method | steps | evaluations | seconds |"
    echo "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |"
    for case in R13_d1 R13_d0999 R05_N10 R05_N40 R08b R12 R14_k1e4 R14_k1e6 R15_M1e-3 R15_M1e-6 R17a_20s R17b; do
        hard_row "$(title "$case")" "$reference/$case.reference.csv" "$reference/$case.yaml" --tolerance 1e-6
    done
    while read -r case system options; do
        against=$reference/$case.reference.csv
        [ "$case" != H_double_1000s ] || against=
        # shellcheck disable=SC2086
        hard_row "$(title "$case")" "$against" "$root/systems/$system/model.yaml" $options
    done <"$reference/hard.txt"
    hard_row "driven pendulum, chaotic, 300 s" "" "$root/systems/hard/driven_pendulum/model.yaml" --tolerance 1e-8
    hard_row "driven pendulum, not chaotic, 300 s" "" "$root/systems/hard/driven_pendulum/model.yaml" --tolerance 1e-8 --set A=0.9
}

# When the chaotic pendulum is lost, by the estimate of the program.
section_lost() {
    echo "| T | error below 10 T up to |"
    echo "| --- | --- |"
    for T in 1e-4 1e-6 1e-8 1e-10; do
        run "$root/systems/hard/driven_pendulum/model.yaml" --tolerance "$T" --verify
        printf '| %s | %g s |\n' "$T" "$(value holds_until)"
    done
}

# ---- work and precision ------------------------------------------------------------------------------------

# cheapest TABLE ERROR LAST: cells of the cheapest setting that meets it: time [ms] or "none", method and setting, evaluations,
# and LAST, its `steps` or its `error`
cheapest() {
    awk -F, -v wanted="$2" -v last="$3" '
        NR > 1 && $5 != "" && $5 <= wanted && (best == "" || $6 < best) {
            best = $6; what = sprintf("%s, %.3g", $1, $2); error = $5; steps = $7; f = $8
        }
        END {
            if (best == "") print "none | | |"
            else printf "%.3g | %s | %d | %s\n", 1e3 * best, what, f, last == "steps" ? steps : sprintf("%.1e", error)
        }' "$1"
}

# figure NAME CASE REFERENCE MODEL OPTION...: table and plot, lines of the table of cheapest settings
figure() {
    name=$1 what=$2 against=$3
    shift 3
    "$COTREE" accuracy "$@" --reference "$against" --error 1e-6 --plot "$work/figures/$name.svg" -o "$work/$name.csv" --quiet
    for wanted in 1e-6 1e-8; do
        echo "| [$what](figures/$name.svg) | $wanted | $(cheapest "$work/$name.csv" "$wanted" steps) |"
    done
}

section_figures() {
    echo "| problem | error | time [ms] | method, tolerance | evaluations | steps |"
    echo "| --- | --- | --- | --- | --- | --- |"
    for case in R05_N1 R05_N2 R05_N10 R01 R06_brick R04 R08b R14_k1e6 R12; do
        figure "accuracy_$case" "$(title "$case")" "$reference/$case.reference.csv" "$reference/$case.yaml"
    done
    figure accuracy_governor "$(title H_governor)" "$reference/H_governor.reference.csv" \
        "$root/systems/hard/flyball_governor/model.yaml"
}

# columns FILE.csv NAME...: t and the columns of these names, without quotes
columns() {
    table=$1
    shift
    awk -F, -v names="t $*" '
        NR == 1 { n = split(names, name, " "); for (i = 1; i <= NF; i++) of[$i] = i }
        { for (i = 1; i <= n; i++) printf "%s%s", (i > 1 ? "," : ""), $(of[name[i]]); print "" }' "$table"
}

# Times of other engines over ours: the error of the output point at the end of the run (of Andrews' mechanism of the
# seven angles).
section_aims() {
    echo "| problem | error | cotree [ms] | method, tolerance or step | evaluations | its error | other engine | [ms] | ratio |"
    echo "| --- | --- | --- | --- | --- | --- | --- | --- | --- |"
    before=
    while IFS=, read -r case wanted its engine; do
        what=$(title "$case")
        set --
        [ "$case" != R05_N40 ] || { set -- --until 10; what="forty four-bars, 10 s"; }
        # a 25th of the run; singular configurations are to be passed with error control
        case $case in
        R05*) step="" point="B0_x B0_y" ;;
        R01) step=0.0012 point="beta theta gamma phi delta omega epsilon" ;;
        *) step=0.4 point="P_x P_y P_z" ;;
        esac
        if [ "$case" != "$before" ]; then
            # shellcheck disable=SC2086 # a list of names
            columns "$reference/$case.reference.csv" $point >"$work/point.csv"
            "$COTREE" accuracy "$reference/$case.yaml" --reference "$work/point.csv" --samples 2 \
                --method dopri5,dop853,radau5 --per-decade 5 -o "$work/aim.csv" --quiet "$@"
            if [ -n "$step" ]; then
                "$COTREE" accuracy "$reference/$case.yaml" --reference "$work/point.csv" --samples 2 \
                    --method rk4,dopri5,dop853 --step "$step" --per-decade 10 -o "$work/fixed.csv" --quiet "$@"
                sed -e 1d -e 's/,/ fixed,/' "$work/fixed.csv" >>"$work/aim.csv"
            fi
        fi
        before=$case
        cells=$(cheapest "$work/aim.csv" "$wanted" error)
        awk -v t="$its" -v ours="${cells%% *}" -v line="| $what | $wanted | $cells | $engine" '
            BEGIN { printf "%s | %s | %s |\n", line, t, (ours + 0 > 0 ? sprintf("%.3g", t / ours) : "") }'
    done <<'END'
R05_N1,1e-6,5.0,RBDL, fixed RK4
R05_N1,1e-8,26,RBDL, fixed RK4
R05_N10,1e-6,69,RBDL
R05_N10,1e-8,350,Pinocchio
R05_N40,1e-6,730,Pinocchio
R05_N40,1e-8,3850,Pinocchio
R01,1e-6,5.1,RBDL, CVODE
R01,1e-8,9.7,RBDL, CVODE
R01,1e-6,2.9,by hand, CVODE
R01,1e-8,4.4,by hand, CVODE
R06_brick,1e-6,2.7,RBDL, CVODE
R06_brick,1e-8,3.0,RBDL, CVODE
END
}

# ---- beams -----------------------------------------------------------------------------------------------------

# Errors of the mesh: against the same beam with a converged basis.
section_elements() {
    echo "| elements | all terms: error | seconds | linear: error | seconds |"
    echo "| --- | --- | --- | --- | --- |"
    for n in 1 2 3 4 5 6 8 10 15 20; do
        line="| $n"
        for kind in "" linear_; do
            sed "s/elements: .*/elements: $n/" "$reference/B01_${kind}N1.yaml" >"$work/beam.yaml"
            if run "$work/beam.yaml" --tolerance 1e-8 --until 8 --samples 5; then
                line="$line | $(error_against "$reference/B01_${kind}fine.reference.csv") | $(value integrate | awk '{ printf "%.2g", $1 }')"
            else
                line="$line | fails |"
            fi
        done
        echo "$line |"
    done
}

# What the source's figures are put beside: five elements with all terms, 30 s.
section_source() {
    echo "| method | steps | set up [s] | run [s] | error at 2, 4, 20 s |"
    echo "| --- | --- | --- | --- | --- |"
    while read -r method option; do
        # shellcheck disable=SC2086 # words
        run "$reference/B01_N5.yaml" --until 30 --samples 4001 --method "$method" $option
        printf '| %s | %s | %s | %s | %s |\n' "$(value method)" "$(value steps)" \
            "$(printf '%s %s %s\n' "$(value read)" "$(value generate)" "$(value compile)" | awk '{ printf "%.2g", $1 + $2 + $3 }')" \
            "$(value integrate | awk '{ printf "%.2g", $1 }')" "$(error_against "$reference/B01_N5.reference.csv")"
    done <<'END'
generalized-alpha --step 0.0075
auto --tolerance 1e-8
END
}

# Errors of the frame: against the exact beam.
section_frames() {
    echo "| frames | elements of each | clamped: largest lag [m] | error | seconds | on the chord: lag [m] | error |"
    echo "| --- | --- | --- | --- | --- | --- | --- |"
    while read -r k n; do
        printf '| %d | %d ' "$k" "$n"
        for frame in clamped chord; do
            "$root/systems/spin_up_welded/generate.sh" "$k" "$n" |
                sed "s/formulation: foreshortening/frame: $frame\n    &/" >"$work/beam.yaml"
            run "$work/beam.yaml" --until 6.76184525385 --samples 2
            awk -F, -v seconds="$(value integrate)" -v frame="$frame" '
                function size(x) { return x < 0 ? -x : x }
                NR == 1 { for (i = 1; i <= NF; i++) if ($i == "across") column = i }
                { v = $column }
                END {
                    printf "| %.9f | %.1e ", v, size(v / -0.573786796554 - 1)
                    if (frame == "clamped") printf "| %.2g ", seconds
                }' "$work/result.csv"
        done
        echo "|"
    done <<'END'
1 10
2 6
4 4
8 3
END
}

# halving CASE SIZE UNTIL COMMAND...: for each N of standard input, of the model that COMMAND N prints, its error against the case and
# that of the values extrapolated from it and the one before; over SIZE, 0: over the largest value of each column
halving() {
    case=$1 common=$2 until=$3
    shift 3
    rm -f "$work/before.csv"
    while read -r n; do
        "$@" "$n" >"$work/beam.yaml"
        run "$work/beam.yaml" --until "$until"
        [ -f "$work/before.csv" ] || cp "$work/result.csv" "$work/before.csv"
        awk -F, -v n="$n" -v common="$common" '
            function size(x) { return x < 0 ? -x : x }
            FNR == 1 { file++; for (i = 1; i <= NF; i++) { if (file == 1) name[i] = $i; of[file, $i] = i }; if (file == 1) n1 = NF; next }
            file == 1 { rows++; for (i = 1; i <= n1; i++) { want[rows, i] = $i; if (size($i) > most[i]) most[i] = size($i) }; next }
            {
                for (r = 1; r <= rows; r++)
                    if (size($1 - want[r, 1]) < 1e-9) {
                        at[file, r] = 1
                        for (i = 2; i <= n1; i++) got[file, r, i] = $(of[file, name[i]])
                    }
            }
            END {
                for (r = 1; r <= rows; r++)
                    for (i = 2; i <= n1 && at[3, r]; i++) {
                        scale = common ? common : most[i]
                        e = size(got[3, r, i] - want[r, i]) / scale
                        x = size((4 * got[3, r, i] - got[2, r, i]) / 3 - want[r, i]) / scale
                        if (e > error) error = e
                        if (x > best) best = x
                    }
                printf "| %d | %.1e | %s |\n", n, error, best == error ? "" : sprintf("%.1e", best)
            }' "$reference/$case.reference.csv" "$work/before.csv" "$work/result.csv"
        cp "$work/result.csv" "$work/before.csv"
    done
}

cantilever() {
    "$root/systems/right_angle_cantilever/generate.sh" "$2" 1 "$1"
}

section_spatial() {
    echo "| frames in each leg | linear twist | quadratic twist |"
    echo "| --- | --- | --- |"
    for twist in linear quadratic; do
        printf '1\n2\n4\n8\n16\n' | halving R11_K8 10 10 cantilever "$twist" | cut -d '|' -f 1-3 >"$work/$twist.errors"
    done
    cut -d '|' -f 3 "$work/quadratic.errors" | paste -d '|' "$work/linear.errors" - | sed 's/$/|/'
}

with_shear() {
    sed -e "s/elements: .*/elements: $1/" \
        -e 's|^    type: beam|    type: beam\n    theory: timoshenko\n    integration: reduced\n    G: E/3\n    shear_factor: 1|' \
        "$reference/R09_K4.yaml"
}

section_orders() {
    echo '| quantity | beam | 16 elements | 32 elements | order |'
    echo '| --- | --- | --- | --- | --- |'
    # shellcheck disable=SC2016 # backquotes of Markdown
    sh "$reference/orders.sh" | sed -n -e 's/^tip,/tip under a force,/;s/^still,/first frequency,/;s/^turning,/the same at 100 rad\/s,/' \
        -e 's/theory: timoshenko, shear_factor: 5\/6/timoshenko/' -e 's/^\([a-z0-9/ ]*\), \(.*\), errors \(.*\), \(.*\): order \(.*\)$/| \1 | `\2` | \3 | \4 | \5 |/p'
}

section_shear() {
    echo "| elements of each frame | error | extrapolated |"
    echo "| --- | --- | --- |"
    printf '1\n2\n4\n8\n' | halving R09_K4 0 7.5 with_shear
}

section_machine() {
    name=$(sed -n 's/^model name[^:]*: *//p' /proc/cpuinfo 2>/dev/null | head -n 1)
    echo "The machine: ${name:-an unknown processor}."
}

# ---- the page ------------------------------------------------------------------------------------------------

sections="machine asked asked_beams hard lost elements source frames spatial shear orders figures aims"

# insert SECTION: what $work/section.md has takes the place of the section in the page
insert() {
    awk -v table="$work/section.md" -v start="<!-- $1 -->" -v end="<!-- /$1 -->" '
        $0 == end { inside = 0; closed = 1 }
        !inside { print }
        $0 == start {
            while ((getline line <table) > 0) print line
            inside = opened = 1
        }
        END { exit !(opened && closed && !inside) }' "$page" >"$page.new" && mv "$page.new" "$page" && return
    rm -f "$page.new"
    echo "accuracy.sh: $page has no lines <!-- $1 --> and <!-- /$1 -->" >&2
    return 1
}

# make SECTION: a part that fails takes nothing with it
make_section() {
    rm -rf "$work/figures"
    mkdir "$work/figures"
    begun=$(date +%s)
    set +e
    (set -e; "section_$1") >"$work/section.md"
    status=$?
    set -e
    echo "$1: $(($(date +%s) - begun)) s" >&2
    if [ "$status" -ne 0 ] || ! insert "$1"; then
        echo "accuracy.sh: '$1' failed; the page keeps what it had there" >&2
        return 1
    fi
    mkdir -p "$docs/figures"
    for figure in "$work"/figures/*.svg; do
        [ ! -f "$figure" ] || mv "$figure" "$docs/figures/"
    done
}

if [ "${1:-}" = --row ]; then
    row "$2" >"${ROWS:?is a folder}/$2"
    exit
fi
# shellcheck disable=SC2086 # a list of words
[ $# -gt 0 ] || set -- $sections
for section in "$@"; do
    case " $sections " in
    *" $section "*) ;;
    *)
        echo "accuracy.sh: no section '$section'; there are: $sections" >&2
        exit 2
        ;;
    esac
done
failed=0
for section in "$@"; do
    make_section "$section" || failed=1
done
exit "$failed"
