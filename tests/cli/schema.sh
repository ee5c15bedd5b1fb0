# The schema is JSON, closed, and knows every component type.
"$COTREE" schema -o schema.json
if command -v python3 >/dev/null; then python3 -m json.tool schema.json >/dev/null; fi && echo valid
grep -c '"additionalProperties": false' schema.json | awk '{ print ($1 > 10) ? "closed" : "open" }'
for type in $("$COTREE" components | sed -n 's/^  \([a-z]*\): .*/\1/p'); do
  grep -q "\"\(body\|joint\|force\)\.$type\": {" schema.json && echo "$type"
done
# Names, numbers and methods are told from others.
grep -c '"pattern": "^\[A-Za-z_\]\[A-Za-z0-9_\]\*\$"' schema.json
sed -n '/^    "simulation"/,/^    "ground"/p' schema.json | grep -A 4 -E '"method"|"not"|"samples": \{'
