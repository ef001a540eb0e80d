#!/bin/sh
# Makes the virtual environment from the lock and installs this project into it, editable. Usage: tools/setup.sh FOLDER
#
# The folder gets a copy of the lock when, and only when, all of it is installed. An equal copy therefore means "ready"; a missing or
# different one means an older or half-finished environment, which is made anew. The editable install never needs the network.
set -eu
cd "$(dirname "$0")/.."
folder=$1

say() { printf 'massline: %s\n' "$*" >&2; }

find_python() {
    for candidate in python3.11 python3 python; do
        if "$candidate" -c 'import sys; sys.exit(sys.version_info[:2] != (3, 11))' 2>/dev/null; then
            command -v "$candidate"
            return
        fi
    done
    say "Python 3.11 is missing (neither python3.11 nor a python3 of that version is on the path)."
    say "On Debian 12, as root: apt-get install python3.11 python3.11-venv"
    return 1
}

python=$(find_python)

if ! "$python" -c 'import ensurepip, venv' 2>/dev/null; then
    say "$python cannot make virtual environments: its modules venv and ensurepip are missing."
    say "On Debian 12, as root: apt-get install python3.11-venv"
    exit 1
fi

"$python" tools/doctor.py

quiet=--quiet
if [ -t 1 ]; then quiet=; fi
pip="sh tools/pip.sh $folder/bin/python"

if ! cmp -s requirements.lock "$folder/installed.lock" || ! "$folder/bin/python" -c '' 2>/dev/null; then
    say "installing $(grep -c '^[a-z0-9].*==' requirements.lock) locked packages into $folder: a minute or more, about 2.8 GB, once."
    "$python" -m venv --clear "$folder"
    $pip install $quiet --require-hashes --only-binary :all: --requirement requirements.lock
    cp requirements.lock "$folder/installed.lock"
fi

$pip install --quiet --no-index --no-deps --no-build-isolation --editable .
