#!/bin/sh
# pip without its remarks on places of packages that hold nothing of what is asked for. Usage: tools/pip.sh PYTHON ARGUMENT ...
#
# Where a machine names more than one index, or a folder of wheels, pip says `WARNING: Location ... is ignored` once a package and
# place, a hundred lines that ask nothing of anybody. Every other warning and error passes, and so does the exit code.
set -eu
python=$1
shift
{
    status=$({ { "$python" -m pip --disable-pip-version-check --no-input "$@" 2>&1 >&4 && echo 0 >&3 || echo $? >&3; } |
        sed -u '/^WARNING: Location .* is ignored: /d' >&2; } 3>&1)
} 4>&1
exit "$status"
