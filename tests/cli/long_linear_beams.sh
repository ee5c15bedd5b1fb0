# Linear beams of many elements: a round-off of their forces is more than speeds are asked for, where nothing moves and where little does.
# The tip hangs at w l^4/(8 E I) from the start on, and methods that do not follow what is not there take few steps.
model() { # ELEMENTS KEYS
  cat <<EOM
cotree: 1
name: long beam
gravity: [0, -9.81, 0]
bodies:
  beam:
    type: beam
    length: 10
    elements: $1
    density: 7850
    E: 2.1e11
    nu: 0.3
    area: 0.01
    Iz: 8.333333333333333e-6
    formulation: linear
    initial: equilibrium
    $2
    points: {tip: length}
joints:
  root: {type: weld, from: ground, to: beam}
EOM
}
run() { # NAME MOST OPTION...: says whether it takes at most so many steps
  name=$1 most=$2
  shift 2
  "$COTREE" simulate model.yaml --quiet -o run.csv --summary summary.json "$@" || return
  steps=$(sed -n 's/^ *"steps": \([0-9]*\),$/\1/p' summary.json)
  [ "$steps" -le "$most" ] && steps="at most $most"
  printf '%s: %s steps, ' "$name" "$steps"
}
compare() { # TIP T
  tail -n 1 run.csv | awk -F, -v tip="$1" -v T="$2" '{ d = ($2 - tip)/tip; print (d*d < 100*T*T ? "within 10 T" : d) }'
}
echo "-- at rest"
{ model 100 ""; echo 'simulation: {duration: 1, samples: 11, tolerance: 1e-8}'; echo 'outputs: [beam.tip.deflection.y]'; } >model.yaml
run radau5 50 --method radau5 && compare -0.5500607142857143 1e-8
run auto 1000 --method auto && compare -0.5500607142857143 1e-8
# The tip is pushed for a tenth of a second by 50 (1 - cos(2 pi t/0.1)) N. Reference: all modes of the same matrices (linear shapes, shear at the
# middle of elements, rotary inertia), found and summed in quadruple precision.
echo "-- pushed"
{
  model 20 'theory: timoshenko
    shear_factor: 0.85
    integration: reduced
    rotary_inertia: true'
  echo 'forces:'
  echo '  push: {type: force, at: beam.tip, value: [0, "if(t < 0.1, 50*(1 - cos(2*pi*t/0.1)), 0)", 0]}'
  echo 'simulation: {duration: 1, samples: 11, tolerance: 1e-10}'
  echo 'outputs: [beam.tip.deflection.y]'
} >model.yaml
run radau5 4000 --method radau5 && compare -0.55471616639922161 1e-10
run auto 6000 --method auto && compare -0.55471616639922161 1e-10
