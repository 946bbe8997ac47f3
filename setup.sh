#!/usr/bin/env bash
# What `make setup` does: system packages, virtual environment, pinned packages, and a look whether gmsh and VTK load.
# `setup.sh dev` installs the packages for tests, style and documentation too.
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
with_pip=(.venv/bin/python -m pip install --no-compile --quiet --disable-pip-version-check --constraint requirements.lock)
packages=(--no-build-isolation --editable ".[${1:-solve}]")

configured=$(.venv/bin/python -m pip config list)

# the value of a setting of pip: that of an environment variable, else of the section install, else of global
setting() {
    local section
    for section in :env: install global; do
        sed -n "s/^$section\.$1='\(.*\)'$/\1/p" <<<"$configured"
    done | sed -n '1{s/\\n/ /g;p}'
}

# uv takes half a minute where pip takes two; it is told where pip looks for packages, and which versions it may take
with_uv() {
    local file constraints=(--constraint requirements.lock)
    for file in $(setting constraint); do constraints+=(--constraint "$file"); done
    "${with_pip[@]}" uv && UV_DEFAULT_INDEX=$(setting index-url) UV_INDEX=$(setting extra-index-url) \
        UV_FIND_LINKS=$(setting find-links | tr ' ' ,) UV_INDEX_STRATEGY=unsafe-best-match \
        .venv/bin/uv pip install --python .venv --quiet "${constraints[@]}" "${packages[@]}"
}

"${with_pip[@]}" setuptools
if [ -n "$(setting no-index)" ]; then
    "${with_pip[@]}" "${packages[@]}"
elif ! said=$(with_uv 2>&1); then
    echo "uv cannot install them (${said##*$'\n'}); pip does it, which takes two minutes"
    "${with_pip[@]}" "${packages[@]}"
fi

# 0.9 GB that nothing here loads: Intel's libraries for graphics cards, for clusters, with indices of 64 bits, functions
# of vectors and other threads; VTK's for graphics cards; tests of packages, names of inner functions, and uv
packages_in=$(echo .venv/lib/python3*/site-packages)
rm -rf .venv/lib/lib{omptarget,ur_,mkl_scalapack,mkl_blacs,mkl_cdft,mkl_intel_ilp64,mkl_vml,mkl_sequential}* .venv/lib/*.dbg
rm -rf .venv/lib/lib{mkl_tbb,tbb,tcm,umf,hwloc}* "$packages_in"/vtkmodules/{libviskores,libvtkAcc,vtkAcc,libvtkTest,vtkTest}*
.venv/bin/python - "$packages_in"/{vtk,vtkmodules/all}.py <<'END'  # `import vtk` works without them
import sys
from pathlib import Path

for file in filter(Path.is_file, map(Path, sys.argv[1:])):
    lines = [one for one in file.read_text().splitlines(True) if "vtkAccelerators" not in one and "vtkTesting" not in one]
    file.unlink()  # the cache of uv has a link to it
    file.write_text("".join(lines))
END
rm -rf "$packages_in"/{numpy,scipy,pandas,numba,matplotlib,distributed,dask}/{,*/,*/*/}tests .venv/share/doc
.venv/bin/python -m pip uninstall --quiet --yes uv
if command -v strip >/dev/null; then
    for library in "$packages_in"/vtkmodules/*.so "$packages_in"/llvmlite/binding/*.so; do
        # into a new file: the cache of uv and other environments have links to this one, which programs may be using
        strip --strip-unneeded -o "$library.new" "$library" && mv "$library.new" "$library" || rm -f "$library.new"
    done
fi

for part in gmsh pictures; do
    if ! said=$(.venv/bin/python -m pipeline.doctor "$part" 2>&1); then
        echo "$part: ${said##*$'\n'}" >&2
        echo "A system library is missing; '.venv/bin/pneurod doctor' names the command that mends it." >&2
        exit 1
    fi
done

echo "compiling the kernels of the solver and of rods, and the packages, which takes a minute"
{
    # packages may hold templates that are no Python
    .venv/bin/python -m compileall -qq -x '/(tests?|pip|setuptools|fontTools|graph_objs|validators)/' \
        .venv/lib geometry fem rod pipeline pneurod >/dev/null 2>&1 || true
    .venv/bin/python -m pipeline.doctor rods >/dev/null
} & beside=$!
.venv/bin/python -m pipeline.doctor threads >/dev/null
wait "$beside"
