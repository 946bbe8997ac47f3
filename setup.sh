#!/usr/bin/env bash
# What `make setup` does: system packages, virtual environment, pinned packages, and a look whether gmsh and VTK load.
# On Debian and Ubuntu root installs what is missing; everybody else is told the one command to run.
set -euo pipefail
cd "$(dirname "$0")"

find_python() {
    local name
    for name in python3.11 python3 python3.12 python3.13; do
        if "$name" -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null; then
            command -v "$name"
            return
        fi
    done
}

missing=()
python=$(find_python)
if [ -z "$python" ]; then
    missing+=(python3.11-venv)
elif ! "$python" -c 'import ensurepip, venv' 2>/dev/null; then
    missing+=("$("$python" -c 'import sys; print(f"python3.{sys.version_info[1]}-venv")')")
fi
if command -v dpkg-query >/dev/null; then
    while read -r package; do
        dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || missing+=("$package")
    done <pipeline/system_packages.txt
fi

if [ ${#missing[@]} -gt 0 ]; then
    install="apt-get update && apt-get install -y --no-install-recommends ${missing[*]}"
    if [ "$(id -u)" -eq 0 ] && command -v apt-get >/dev/null; then
        echo "installing system packages: ${missing[*]}"
        DEBIAN_FRONTEND=noninteractive bash -c "$install" >/dev/null
        python=$(find_python)
    else
        echo "Some system packages are missing. Run this once, then make again:" >&2
        echo "    sudo sh -c '$install'" >&2
        exit 1
    fi
fi
if [ -z "$python" ]; then
    echo "Python 3.11 or later is needed; install it, then run make again." >&2
    exit 1
fi

if ! .venv/bin/python -m pip --version >/dev/null 2>&1; then
    echo "making .venv with $("$python" --version)"
    "$python" -m venv --clear .venv
fi
echo "installing the pinned packages into .venv"
# Python modules are compiled at the end, on one core while another compiles the kernels
install=(.venv/bin/python -m pip install --no-compile --quiet --disable-pip-version-check --constraint requirements.lock)
"${install[@]}" setuptools
"${install[@]}" --no-build-isolation --editable '.[dev]'

for part in gmsh pictures; do
    if ! said=$(.venv/bin/python -m pipeline.doctor "$part" 2>&1); then
        echo "$part: ${said##*$'\n'}" >&2
        echo "A system library is missing; '.venv/bin/pneurod doctor' names the command that mends it." >&2
        exit 1
    fi
done

echo "compiling the kernels of the solver and the packages, which takes a minute"
.venv/bin/python -m compileall -qq .venv/lib >/dev/null 2>&1 & modules=$!
.venv/bin/python -m pipeline.doctor threads >/dev/null
wait "$modules" || true # packages may hold templates that are no Python
