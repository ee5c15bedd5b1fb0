# The scripts that complete command lines: each shell that is there reads its own, bash and fish complete by it.
"$COTREE" completion bash >cotree.bash
"$COTREE" completion zsh >_cotree
"$COTREE" completion fish >cotree.fish
for file in cotree.bash _cotree cotree.fish; do
  [ -s "$file" ] || echo "$file is empty"
done

# every command, and every option that its help lists, is in each of them
for command in $("$COTREE" --help | sed -n 's/^  \([a-z]*\)  .*/\1/p'); do
  grep -q "^  $command)\$" cotree.bash || echo "bash: no $command"
  grep -q "^    $command)\$" _cotree || echo "zsh: no $command"
  for option in $("$COTREE" "$command" --help | sed -n 's/^  \(-[a-z], \)*--\([a-z-]*\).*/\2/p'); do
    sed -n "/^  $command)\$/,/esac/p" cotree.bash | grep -q -- "--$option " || echo "bash: no $command --$option"
    sed -n "/^    $command)\$/,/ ;;/p" _cotree | grep -q -- "--$option\\[\\|--$option}" || echo "zsh: no $command --$option"
    grep -q "from $command' -l $option " cotree.fish || echo "fish: no $command --$option"
  done
done
# methods are listed by hand
for method in $("$COTREE" methods | sed 's/ .*//'); do
  grep -q -- "--method) words='[^']*\\<$method\\>" cotree.bash || echo "bash: no method $method"
done

cat >try.bash <<'END'
. ./cotree.bash
try() {
  COMP_WORDS=("$@")
  COMP_CWORD=$((${#COMP_WORDS[@]} - 1))
  _cotree
  echo "$*: $(printf '%s\n' "${COMPREPLY[@]}" | sort | paste -sd ' ')"
}
try cotree si
try cotree help si
try cotree --quiet simulate --to
try cotree simulate model.yaml --method ra
try cotree graph --format s
try cotree completion z
try cotree simulate cotree.
END
if command -v bash >/dev/null; then
  bash -n cotree.bash && bash try.bash
else # what it says there
  cat <<'END'
cotree si: simulate
cotree help si: simulate
cotree --quiet simulate --to: --tolerance
cotree simulate model.yaml --method ra: radau5
cotree graph --format s: svg
cotree completion z: zsh
cotree simulate cotree.: cotree.bash cotree.fish
END
fi
if command -v zsh >/dev/null; then
  zsh -n _cotree
fi
if command -v fish >/dev/null; then
  fish -n cotree.fish
  HOME=$PWD fish --no-config -c 'source cotree.fish; complete -C "cotree si"; complete -C "cotree simulate --tol"' >fish.txt
  [ "$(sed 's/\t.*//' fish.txt | tr '\n' ' ')" = "simulate --tolerance " ] || cat fish.txt
fi
