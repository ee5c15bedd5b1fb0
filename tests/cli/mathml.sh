# Equations in HTML: MathML that is well-formed for every system, and names that would break a page.
. "$(dirname "$0")/lib.sh"

cat >well_formed.py <<'END'
# Each page is XML, and each element of MathML has the children it takes.
import sys, xml.etree.ElementTree as tree
children = {'mfrac': 2, 'msub': 2, 'msup': 2, 'msubsup': 3, 'mover': 2}
for name in sys.argv[1:]:
    root = tree.parse(name).getroot()
    for e in root.iter():
        if len(e) != children.get(e.tag, len(e)):
            print(name, e.tag, len(e))
        if e.tag == 'script' or any(k.startswith('on') for k in e.keys()):
            print(name, 'has a script')
END

echo '-- every system is well-formed'
n=0
for s in "$SYSTEMS"/*/model.yaml; do
  "$COTREE" equations "$s" --format html -o "$(basename "$(dirname "$s")").html" 2>/dev/null && n=$((n + 1))
done
[ "$n" -gt 30 ] && echo systems
if command -v python3 >/dev/null; then python3 well_formed.py ./*.html; fi && echo 'well-formed'

echo '-- equations have the names of their speeds and rows'
grep -o 'data-equation="[^"]*"' slider_crank.html

echo '-- the name of the model and the column of a table are text'
printf 't,a</mi><script>alert(1)</script> & ) + (b \\ ^~_{}\342\200\256\n0,0\n1,1\n' >force.csv
cat >hostile.yaml <<'END'
cotree: 1
name: "</title><script>alert(1)</script> \" ' & %n \u202E \u2067"
bodies: {cart: {mass: 1}}
joints:
  rail:
    type: prismatic
    from: ground
    to: cart
    effort: {table: force.csv, interpolate: linear, column: "a</mi><script>alert(1)</script> & ) + (b \\ ^~_{}\u202E"}
END
say equations hostile.yaml --format html --show reduced | sed -n '/<title>/p; /data-equation/p'
"$COTREE" equations hostile.yaml --format html --show all -o hostile.html
if command -v python3 >/dev/null; then python3 well_formed.py hostile.html; fi && echo 'well-formed'
