# Debian 12 packages that the tree needs, one list for what builds it and one for what its tests compare against.
# Sourced by tools/demo and tools/test.
build_packages=(
  ca-certificates git g++ cmake ninja-build ccache pkg-config
  libtbb-dev libopenvdb-dev libboost-dev libboost-iostreams-dev libblosc-dev
  libembree-dev libopenmesh-dev libeigen3-dev zlib1g-dev libxxhash-dev
  libcli11-dev libtomlplusplus-dev libfmt-dev nlohmann-json3-dev
  libdeflate-dev libjemalloc-dev libgtest-dev libgmock-dev libbenchmark-dev
)
test_packages=(openfoam openfoam-examples python3-openvdb python3-vtk9)
# Peers that benchmarks/run measures beside ours; built and run only where they are.
benchmark_packages=(libp4est-dev libopenmpi-dev openmpi-bin)

# Installs those of the named packages that dpkg does not already have; silent and quick when there are none.
install_packages() {
  local missing=() package
  for package in "$@"; do
    [[ $(dpkg-query -W -f='${db:Status-Abbrev}' "$package" 2>/dev/null) == ii* ]] || missing+=("$package")
  done
  ((${#missing[@]})) || return 0
  echo "Installing ${#missing[@]} Debian packages: ${missing[*]}"
  local as_root=()
  ((EUID == 0)) || as_root=(sudo)
  "${as_root[@]}" apt-get -q update
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q -y install --no-install-recommends "${missing[@]}"
}

# Configures and builds with the release preset; warnings are errors under CI.
build_release() {
  cmake --preset release -DI2B_WARNINGS_AS_ERRORS="$([[ -n ${CI:-} ]] && echo ON || echo OFF)"
  cmake --build --preset release -j "${I2B_JOBS:-$(nproc)}"
}
