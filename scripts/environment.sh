# shellcheck shell=bash
# Sourced by the other scripts: where things are, what this machine has, and which HDF5 the build takes.

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

# Python packages that the build or the checks need, away from those of the system.
venv=$root/.venv

# Where cargo builds.
target=${CARGO_TARGET_DIR:-target}
[[ $target == /* ]] || target=$root/$target

# rustup changes PATH only for shells that start after it.
[[ ! -d $HOME/.cargo/bin ]] || PATH=$PATH:$HOME/.cargo/bin

# Whether a command exists.
has() {
    command -v "$1" >/dev/null 2>&1
}

# version_at_least FOUND WANTED: whether a version "major.minor..." is new enough.
version_at_least() {
    local found_major found_minor wanted_major wanted_minor
    IFS=. read -r found_major found_minor _ <<<"$1."
    IFS=. read -r wanted_major wanted_minor _ <<<"$2."
    ((found_major > wanted_major || (found_major == wanted_major && ${found_minor:-0} >= wanted_minor)))
}

# Whether this is macOS with Homebrew.
has_brew() {
    [[ $OSTYPE == darwin* ]] && has brew
}

# Whether the build finds an HDF5 library: named by the user, known to pkg-config, or Homebrew's.
has_hdf5() {
    [[ -n ${HDF5_DIR:-} ]] || { has pkg-config && pkg-config --exists hdf5; } ||
        { has_brew && [[ -d $(brew --prefix)/opt/hdf5 ]]; }
}

# Builds the Python module and installs it in `venv`, unless it is there.
prepare_module() {
    "$venv/bin/python" -c "import stsolve" 2>/dev/null || "$root/scripts/wheel" --here
}

# Whether the feature mpi can be built and run: a compiler and a launcher of MPI, and libclang with its headers, which reads those of MPI.
# On macOS libclang comes with Apple's compiler.
has_mpi() {
    has mpicc && has mpirun && has_libclang
}

# Which MPI mpicc belongs to, as Debian names its packages.
mpi_kind() {
    if has mpicc && mpicc -show 2>/dev/null | grep -q mpich; then echo mpich; else echo openmpi; fi
}

# The folder of an HDF5 library that is built with the MPI of mpicc, if there is one: named by the user, Debian's, or Homebrew's.
parallel_hdf5() {
    local folder
    for folder in "${HDF5_DIR:-}" /usr/lib/*/hdf5/"$(mpi_kind)" "$(if has_brew; then brew --prefix hdf5-mpi 2>/dev/null; fi)"; do
        if grep -qs "define H5_HAVE_PARALLEL 1" "$folder"/include/H5pubconf.h; then
            printf '%s\n' "$folder"
            return
        fi
    done
}

has_libclang() {
    [[ $OSTYPE == darwin* || -n ${LIBCLANG_PATH:-} ]] ||
        compgen -G "/usr/lib*/llvm*/lib*/libclang.so" >/dev/null || compgen -G "/usr/lib*/libclang.so" >/dev/null
}

# Lets Open MPI, version 4 or 5, start more ranks than there are cores, as root too. Ranks that wait leave their core to others.
allow_many_ranks() {
    export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_mpi_yield_when_idle=1
    export OMPI_MCA_rmaps_base_oversubscribe=1 PRTE_MCA_rmaps_default_mapping_policy=:oversubscribe
}

# Without the system's library, HDF5 is built in; the tools for that may be those of `venv`. `hdf5_feature` is for cargo.
# shellcheck disable=SC2034
hdf5_feature=
use_hdf5() {
    has_hdf5 && return
    # shellcheck disable=SC2034
    hdf5_feature=stsolve/static-hdf5
    PATH=$venv/bin:$PATH
    [[ ! -x $venv/bin/ninja ]] || export CMAKE_GENERATOR=Ninja
}
