#!/bin/sh
# The tests of the Python package with the first Python that has NumPy and pytest; 77, skipped, where none has.
#   run.sh ROOT LIBRARY
set -eu
root=$1
for python in python3 /usr/bin/python3; do
  "$python" -c 'import numpy, pytest' 2>/dev/null || continue
  PYTHONPATH=$root/python COTREE_LIBRARY=$2 PYTHONDONTWRITEBYTECODE=1
  export PYTHONPATH COTREE_LIBRARY PYTHONDONTWRITEBYTECODE
  exec "$python" -m pytest -q -p no:cacheprovider "$root/tests/python"
done
echo "no Python with NumPy and pytest"
exit 77
