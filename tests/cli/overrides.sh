# Wrong overrides are mistakes of the command line.
. "$(dirname "$0")/lib.sh"
m=$SYSTEMS/slider_crank/model.yaml
say check "$m" --set torqe=1
say check "$m" --set torque
say check "$m" --set torque=1+
say check "$m" --set r=1/0 --set m9=1
say check "$m" --set m1=-1
say check "$m" --set m1=2*m1
"$COTREE" check "$m" --set r='100 mm' --set torque=2*r >/dev/null && echo right
