# Switches whose argument is zero at the start: they change as soon as the motion leaves zero, they stay where it does
# not, and where both sides lead back the run says so. Values are those of formulas.
. "$(dirname "$0")/lib.sh"
# cart EFFORT [KEYS OF initial] [OPTIONS]: s.q and s.u at 1 s less what WANT_Q and WANT_U say, or the error
cart() {
  cat >cart.yaml <<END
cotree: 1
bodies: {cart: {mass: 1}}
joints:
  s: {type: prismatic, from: ground, to: cart, effort: "$1", initial: {$2}}
simulation: {duration: 1, samples: 11}
outputs: [s.q, s.u]
END
  shift 2
  "$COTREE" simulate cart.yaml --quiet "$@" -o cart.csv >said 2>&1 || {
    sed -n 's/.*error: \(.*\): on both.* \(\[.*\)/\1 \2/p' said
    return
  }
  tail -1 cart.csv | awk -F, -v q="$WANT_Q" -v u="$WANT_U" -v tol="${TOL:-1e-9}" '{
    dq = $2 - q; du = $3 - u; near = dq < tol && dq > -tol && du < tol && du > -tol
    print near ? "as the formula" : $2 ", " $3 }'
}
methods='--method=auto --method=dopri5 --method=dop853 --method=radau5 --method=generalized-alpha'
each() {
  echo "-- $1 {$2}"
  for m in $methods; do cart "$1" "$2" $m; done | sort | uniq -c | sed 's/^ *//'
  for m in rk4 dop853 radau5; do TOL=1e-7 cart "$1" "$2" --method $m --step 0.01; done | sort | uniq -c |
    sed 's/^ *\([0-9]*\)/\1 with fixed steps/'
}
floor() {
  echo "-- $1 {$2}"
  for m in dopri5 dop853 radau5; do cart "$1" "$2" --method $m; done
  TOL=1e-3 cart "$1" "$2" --method dop853 --step 0.01
}
# dry friction 0.1 against a force that begins at zero holds the cart, also from a tiny speed
each '0.5*t - 0.1*sign(s.u)' ''
cart '0.5*t - 0.1*sign(s.u)' 'u: 1e-9'
each '0.5*t + if(s.u > 0, -0.1, 0)' ''
each '0.05 - 0.1*sign(s.u)' ''
each 'max(t - 0.5, 0) - 0.1*sign(s.u)' ''
# a force above the friction that is there at once, from the start or from 0.5 s on
WANT_Q=0.2 WANT_U=0.4 each '0.5 - 0.1*sign(s.u)' ''
WANT_Q=0.1125 WANT_U=0.45 each 'if(t < 0.5, 0, 1) - 0.1*sign(s.u)' ''
WANT_Q=-0.1125 WANT_U=-0.45 each 'if(t < 0.5, 0, -1) - 0.1*sign(s.u)' ''
# nothing moves: sign(0) is 0
WANT_Q=0 WANT_U=0 each '-0.1*sign(s.u)' ''
WANT_Q=0 WANT_U=0 each 'sign(0*s.q)*max(s.u, 0) - 0.1*sign(s.u)*abs(s.q)' ''
# 1/2 t^2 + t^4/12: away from zero with the fourth power of time, and the same to the other side
WANT_Q=0.5833333333333333 WANT_U=1.3333333333333333 TOL=1e-8 each 'sign(s.q) + t^2' ''
WANT_Q=-0.5833333333333333 WANT_U=-1.3333333333333333 TOL=1e-8 each 'sign(s.q) - t^2' ''
# u = tanh(t) and -tanh(t) with drag u |u|; q = log cosh t
WANT_Q=0.4337808304830271 WANT_U=0.7615941559557649 TOL=1e-7 each '1 - s.u*abs(s.u)' ''
WANT_Q=-0.4337808304830271 WANT_U=-0.7615941559557649 TOL=1e-7 each '-1 - s.u*abs(s.u)' ''
# with 0.5 t - 0.1 |u|: u = 50 (0.1 t - 1 + e^(-0.1 t)), q = 50 (0.05 t^2 - t + 10 (1 - e^(-0.1 t)))
WANT_Q=0.08129098202023 WANT_U=0.24187090179798 TOL=1e-7 each '0.5*t - 0.1*abs(s.u)' ''
# from q = 0 with a speed: sign(q) is that of the speed
WANT_Q=0.8 WANT_U=0.6 each '-0.4*sign(s.q)' 'u: 1'
WANT_Q=-0.8 WANT_U=-0.6 each '-0.4*sign(s.q)' 'u: -1'
# on a floor of stiffness 1000 that it starts on or swings up to: -0.01 (1 -+ cos sqrt(1000) t) is never above zero
WANT_Q=-2.131730344011e-4 WANT_U=-0.06494626968060407 TOL=1e-9 floor '-10 + if(s.q < 0, -1000*s.q, 0)' ''
WANT_Q=-0.01978682696559892 WANT_U=0.06494626968060407 TOL=1e-9 floor '-10 + if(s.q < 0, -1000*s.q, 0)' 'q: -0.02'

echo '-- a force that is round-off beside the other states holds nothing, a larger one does'
for force in 3e-15 -3e-15 5e-14; do
  cat >two.yaml <<END
cotree: 1
bodies: {cart: {mass: 1, inertia: 1}}
joints:
  s: {type: planar, normal: z, from: ground, to: cart, initial: {q: [1, 0, 0]}, effort: [~, "$force*s.q1 - 0.1*sign(s.u2)", ~]}
simulation: {duration: 1, samples: 2}
outputs: [s.q2]
END
  "$COTREE" simulate two.yaml --quiet --keep-all -o two.csv 2>&1 | sed -n 's/.*error: \(.*\): on both.* \(\[.*\)/\1 \2/p'
  [ -e two.csv ] && awk -F, 'END { q = $2 + 0; print (q < 1e-14 && q > -1e-14) ? "at rest" : q }' two.csv
  rm -f two.csv
done

echo '-- members of a sweep as alone'
cat >sweep.yaml <<'END'
cotree: 1
parameters: {F: 1, mu: 0}
bodies: {cart: {mass: 1}}
joints:
  s: {type: prismatic, from: ground, to: cart, effort: "F*t - 0.1*abs(s.u) - mu*sign(s.u)"}
simulation: {duration: 1, samples: 2}
outputs: [s.q, s.u]
END
"$COTREE" sweep sweep.yaml --vary F=-2:2:8 --quiet -o sweep.csv
for run in 1 4 5 8; do
  row=$(sed -n "$((run + 1))p" sweep.csv)
  "$COTREE" simulate sweep.yaml --set F="$(echo "$row" | cut -d, -f2)" --quiet -o run.csv
  same_row $run "$(echo "$row" | cut -d, -f3-4)"
done
"$COTREE" sweep sweep.yaml --vary F=-2:2:2 --set mu=3 -o sweep.csv 2>&1 | grep -c E406
