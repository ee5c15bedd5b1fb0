# Exported C in a loop: steps, projection, switches, impulses, derived parameters, names that would end a comment.
. "$(dirname "$0")/lib.sh"
warnings='-std=c99 -Wall -Wextra -Wpedantic -Wconversion -Werror'
# build FOLDER FILES: the self-test and a program of its own, under sanitizers
build() {
  (cd "$1" && cc $warnings -O1 -fsanitize=address,undefined -fno-sanitize-recover -I. -o self_test ./*.c -lm && ./self_test &&
    cc $warnings -O1 -I. -o loop "../$2" "$(ls ./*.c | grep -v _test)" -lm)
}

echo '-- ten seconds of a slider-crank at 1 ms'
cat >slider.c <<'E2'
#include "slider_crank.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

int main(void)
{
    static double in[SLIDER_CRANK_NINPUT], work[SLIDER_CRANK_NWORK], out[SLIDER_CRANK_NCONSTRAINT];
    double most = 0;
    int i, k;
    memcpy(in, slider_crank_start, sizeof in);
    for (k = 1; k <= 10000; k++) {
        if (slider_crank_step(in, 1e-3, work))
            return 1;
        slider_crank_constraint(in, out);
        for (i = 0; i < 2 * SLIDER_CRANK_NROW; i++)
            most = fmax(most, fabs(out[i]));
    }
    printf("t = %.9g, constraints below 1e-9: %s\n", in[SLIDER_CRANK_T], most < 1e-9 ? "yes" : "no");
    in[SLIDER_CRANK_Q] += 0.01;
    in[SLIDER_CRANK_U] += 1;
    printf("projection: %d\n", slider_crank_project(in, work));
    slider_crank_constraint(in, out);
    printf("closed: %s\n", fabs(out[0]) < 1e-9 && fabs(out[SLIDER_CRANK_NROW]) < 1e-9 ? "yes" : "no");
    return 0;
}
E2
"$COTREE" export "$SYSTEMS/slider_crank/model.yaml" -o slider
build slider slider.c && slider/loop
cat >bars.c <<'E2'
#include "four_bar.h"
#include <stdio.h>
#include <string.h>

int main(void)
{
    static double in[FOUR_BAR_NINPUT], work[FOUR_BAR_NWORK];
    in[0] = 0;
    memcpy(in, four_bar_start, sizeof in);
    in[FOUR_BAR_PARAMETER] = 10; /* the crank: no bars reach back from its end */
    in[FOUR_BAR_Q] = 1;
    printf("a loop that nothing closes: %d, %d, as it was: %s\n", four_bar_project(in, work),
           four_bar_step(in, 1e-3, work), in[FOUR_BAR_Q] == 1 && in[FOUR_BAR_T] == 0 ? "yes" : "no");
    return 0;
}
E2
"$COTREE" export "$SYSTEMS/four_bar/model.yaml" -o bars
build bars bars.c && bars/loop

# loop NAME STEP SAMPLES: rows of t and outputs, SAMPLES of them behind the start, three steps between two
loop() {
  upper=$(echo "$1" | tr a-z A-Z)
  cat <<E2
#include "$1.h"
#include <stdio.h>
#include <string.h>

int main(void)
{
    static double in[${upper}_NINPUT], work[${upper}_NWORK], out[${upper}_NOUTPUT];
    int i, k;
    memcpy(in, $1_start, sizeof in);
    for (k = 0; k <= 3 * $3; k++) {
        if (k % 3 == 0) {
            $1_outputs(in, out);
            printf("%.9f", in[${upper}_T]);
            for (i = 0; i < ${upper}_NOUTPUT; i++)
                printf(",%.12g", out[i]);
            printf("\n");
        }
        if ($1_step(in, $2 / 3.0, work))
            return 1;
    }
    return 0;
}
E2
}

# follow NAME STEP SAMPLES TOLERANCE: outputs of exported steps against those of simulate
follow() {
  echo "-- $1"
  "$COTREE" export "$1.yaml" -o "$1"
  loop "$1" "$2" "$3" >"$1.c"
  build "$1" "$1.c"
  "$COTREE" simulate "$1.yaml" --quiet --tolerance 1e-10 -o run.csv
  { head -1 run.csv; "$1/loop"; } >steps.csv
  difference run.csv steps.csv | awk -v most="$4" '{ print ($1 + 0 == $1 && $1 <= most ? "as simulated" : "differs: " $0) }'
}

cat >ball.yaml <<'E2'
cotree: 1
name: ball
parameters: {m: 0.2, stiffness: 2000, damping: 0.05*sqrt(stiffness*m)}
gravity: [0, 0, -9.81]
bodies: {ball: {type: particle, mass: m}}
joints:
  height:
    type: prismatic
    from: ground
    to: ball
    axis: z
    initial: {q: 0.5}
    effort: "if(height.q < 0, -stiffness*height.q - damping*height.u, 0) - 0.02*abs(height.u)*height.u"
outputs:
  - height.q
  - height.u
  - height.a
  - {name: contact, value: "if(height.q < 0, 1, 0)"}
  - energy.total
simulation: {duration: 2, samples: 1001, tolerance: 1e-8}
E2
follow ball 0.002 1000 1e-5
grep -c 'NROOT = 0' ball/ball.h

cat >crank.yaml <<'E2'
cotree: 1
name: crank
parameters: {l: 0.5, speed: 2, m: 1}
gravity: [0, -9.81, 0]
bodies:
  crank: {mass: m, com: [l/2, 0, 0], inertia: m*l^2/12, points: {tip: [l, 0, 0]}}
  rod: {mass: 2*m, com: [l, 0, 0], inertia: 2*m*l^2/3}
joints:
  drive: {type: revolute, from: ground, to: crank, motion: "if(t < 0.3, 0, speed*(t - 0.3))"}
  pin: {type: revolute, from: crank.tip, to: rod, initial: {q: -0.2}, effort: "-0.1*pin.u - 0.05*sign(pin.u)*pin.u^2"}
outputs: [pin.q, pin.u, energy.kinetic, energy.total]
simulation: {duration: 1, samples: 101}
E2
follow crank 0.01 100 1e-6

printf 't,angle\n0,0\n0.2537,0.4\n0.5031,-0.2\n0.8013,0\n2,0\n' >ramp.csv
sed 's/name: crank/name: tabled/; s/motion: "[^"]*"/motion: {table: ramp.csv, column: angle, interpolate: linear}/' crank.yaml >tabled.yaml
follow tabled 0.01 100 1e-6

echo '-- derived parameters, and where they stand'
cat >parameters.c <<'E2'
#include "ball.h"
#include <stdio.h>
#include <string.h>

int main(void)
{
    double in[BALL_NINPUT];
    memcpy(in, ball_start, sizeof in);
    in[2] = 8000;
    ball_parameters(in);
    printf("m %g stiffness %g damping %g\n", in[1], in[2], in[3]);
    return 0;
}
E2
cc $warnings -Iball -o parameters parameters.c ball/ball.c -lm && ./parameters
sed -n '/"parameters"/,/^  ]/p; /"coordinates"/,/^  ]/p; /"states"/p; /"outputs"/,/^  ]/p' ball/ball.json

echo '-- dry friction, where the motion sticks: a step says so and goes on'
cat >dry.yaml <<'E2'
cotree: 1
name: dry
gravity: [0, 0, 0]
bodies: {block: {mass: 1}}
joints: {slide: {type: prismatic, from: ground, to: block, axis: x, initial: {u: 1}, effort: "-2*sign(slide.u)"}}
outputs: [slide.q]
simulation: {duration: 0.4}
E2
cat >dry.c <<'E2'
#include "dry.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

int main(void)
{
    double in[DRY_NINPUT], work[DRY_NWORK];
    int k, first = 0;
    memcpy(in, dry_start, sizeof in);
    for (k = 1; k <= 1000; k++)
        if (dry_step(in, 1e-3, work) && !first)
            first = k;
    printf("first in step %d; then %s at %.3f\n", first, fabs(in[DRY_U]) < 3e-3 ? "at rest" : "moving", in[DRY_Q]);
    return 0;
}
E2
"$COTREE" export dry.yaml -o dry
build dry dry.c && dry/loop

echo '-- names that would end a comment or a line'
cat >names.yaml <<'E2'
cotree: 1
name: 'a */ int x; // ??/ \'
gravity: [0, 0, 0]
bodies: {block: {mass: 1}}
joints: {slide: {type: prismatic, from: ground, to: block, axis: x, initial: {q: 1}, effort: "-slide.q"}}
outputs:
  - {name: "one\n#error */ two\\", value: slide.q}
simulation: {duration: 1}
E2
"$COTREE" export names.yaml -o names
(cd names && cc $warnings -trigraphs -o self_test ./*.c -lm && ./self_test)
"$COTREE" equations names.yaml --format c >equations.c
cc -std=c99 -trigraphs -Wall -Wextra -Werror -c -o equations.o equations.c && echo compiled

echo '-- what cannot be exported'
sed '/^simulation/s/}/, rate_jumps: continuous}/' crank.yaml >continuous.yaml
say export continuous.yaml -o continuous
