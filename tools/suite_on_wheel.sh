#!/bin/sh
# Builds the wheel, unpacks it into a folder of its own and runs the whole suite against it. Usage: tools/suite_on_wheel.sh [PYTEST ARGUMENT ...]
#
# The locked packages come from .venv. The wheel's folder stands before them on PYTHONPATH, which reaches every process that a test
# starts; -P and a neutral working directory keep the source tree out. `tests/architecture/test_origin.py` checks that it worked.
#
# Two processes share the suite: each begins at its end of one half in order, so that what tests of one file share is made once, and
# whoever is done first takes half of what the other has left. An argument `-n 4` or `-n 0` (this process alone) overrides that.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
python=$root/.venv/bin/python
wheel=$root/build/wheel

rm -rf "$wheel"
mkdir -p "$wheel/neutral"
sh "$root/tools/pip.sh" "$python" wheel --quiet --no-index --no-deps --no-build-isolation --wheel-dir "$wheel" "$root"
sh "$root/tools/pip.sh" "$python" install --quiet --no-index --no-deps --target "$wheel/site" "$wheel"/massline-*.whl

cd "$wheel/neutral"
MASSLINE_UNDER_TEST=$wheel/site PYTHONPATH=$wheel/site exec "$python" -P -m pytest -n 2 --dist worksteal "$root/tests" "$@"
