#!/bin/sh
# Makes the virtual environment from the lock and installs this project into it, editable. Usage: tools/setup.sh FOLDER
#
# The folder gets a copy of the lock when, and only when, all of it is installed. An equal copy therefore means "ready"; a missing or
# different one means an older or half-finished environment, which is made anew. The editable install never needs the network.
set -eu
cd "$(dirname "$0")/.."
folder=$1

say() { printf 'massline: %s\n' "$*" >&2; }

locked=$(sed -n 's/^LOCKED := //p' Makefile) # oldest first
oldest=${locked%% *}
newest=${locked##* }
debian() { say "On Debian 12, as root: apt-get install $*"; }

version() { "$1" -c 'import sys; print("%d.%d" % sys.version_info[:2])' 2>/dev/null; }

# Sets `python`: what PYTHON names, else the Python of the environment that is there, else the newest of the locked ones that is found.
find_python() {
    if [ -n "${PYTHON:-}" ]; then
        found=$(version "$PYTHON") || { say "PYTHON=$PYTHON cannot be started as a Python; give its name or path, as in PYTHON=python$newest."; exit 1; }
        case " $locked " in
            *" $found "*) python=$PYTHON; say "Python $found, because PYTHON=$PYTHON says so."; return ;;
        esac
        say "PYTHON=$PYTHON is Python $found, and requirements.lock is for $locked: name one of these."
        exit 1
    fi
    found=$(version "$folder/bin/python") || found=
    case " $locked " in
        *" $found "*) python=$folder/bin/python; return ;;
    esac
    newest_first=
    for wanted in $locked; do newest_first="$wanted $newest_first"; done
    lame=
    for wanted in $newest_first; do
        for candidate in "python$wanted" python3 python; do
            [ "$(version "$candidate")" = "$wanted" ] || continue
            python=$(command -v "$candidate")
            if "$candidate" -c 'import ensurepip, venv' 2>/dev/null; then
                say "Python $wanted ($python), the newest of $locked found on the path; PYTHON=python$oldest would pick another."
                return
            fi
            lame=${lame:-$wanted}
            say "$python is passed over: it cannot make virtual environments, its modules venv and ensurepip are missing."
            break
        done
    done
    if [ -n "$lame" ]; then
        debian "python$lame-venv"
    else
        say "No Python of $locked is found on the path, and requirements.lock is for these alone."
        debian "python3.11 python3.11-venv"
    fi
    exit 1
}

find_python

"$python" tools/doctor.py

quiet=--quiet
if [ -t 1 ]; then quiet=; fi
pip="sh tools/pip.sh $folder/bin/python"

if ! cmp -s requirements.lock "$folder/installed.lock" || [ "$(version "$folder/bin/python")" != "$(version "$python")" ]; then
    say "installing $(grep -c '^[a-z0-9].*==' requirements.lock) locked packages into $folder: a minute or more, about 2.8 GB, once."
    base=$("$python" -c 'import sys; print(getattr(sys, "_base_executable", sys.executable))') # the environment's own is about to be cleared
    "$base" -m venv --clear "$folder"
    $pip install $quiet --require-hashes --only-binary :all: --requirement requirements.lock
    cp requirements.lock "$folder/installed.lock"
fi

$pip install --quiet --no-index --no-deps --no-build-isolation --editable .
