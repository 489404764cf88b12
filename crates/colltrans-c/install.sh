#!/bin/sh
# Builds and installs the C and C++ interface: headers, libraries, files for pkg-config and CMake.
#
#     install.sh PREFIX              build with cargo, install below PREFIX
#     install.sh PREFIX LIBRARIES    install the libraries that are built in the folder LIBRARIES
set -eu
[ $# -ge 1 ] || { echo "usage: install.sh PREFIX [LIBRARIES]" >&2; exit 2; }
here=$(CDPATH='' cd -- "$(dirname -- "$0")" && pwd)
prefix=$1
if [ $# -ge 2 ]; then
    libraries=$2
else
    # cargo reports where the library is, which depends on its configuration.
    built=$(cargo build --release --locked --manifest-path "$here/Cargo.toml" --message-format=json-render-diagnostics)
    library=$(printf '%s\n' "$built" | sed -n 's|.*"\([^"]*/libcolltrans_c\.a\)".*|\1|p' | tail -n 1)
    libraries=$(dirname -- "$library")
fi
# The manifest of a package has the version, that of the repository refers to its workspace.
version=$(cat "$here/Cargo.toml" "$here/../../Cargo.toml" 2>/dev/null | sed -n 's/^version = "\(.*\)"$/\1/p' | head -n 1)
abi=$(sed -n 's/^#define COLLTRANS_ABI \([0-9]*\)$/\1/p' "$here/include/colltrans.h")

mkdir -p "$prefix/include" "$prefix/lib/pkgconfig" "$prefix/lib/cmake/colltrans"
cp "$here/include/colltrans.h" "$here/include/colltrans.hpp" "$prefix/include/"
cp "$libraries/libcolltrans_c.a" "$prefix/lib/"
if [ -f "$libraries/libcolltrans_c.dylib" ]; then
    loaded=libcolltrans_c.$abi.dylib linked=libcolltrans_c.dylib soname=@rpath/$loaded
else
    loaded=libcolltrans_c.so.$abi linked=libcolltrans_c.so soname=$loaded
fi
if [ ! -f "$libraries/$linked" ]; then
    echo "no $linked in $libraries; for musl, build with RUSTFLAGS=-Ctarget-feature=-crt-static" >&2
    exit 1
fi
# Programs that run keep the old file.
rm -f "$prefix/lib/$loaded"
cp "$libraries/$linked" "$prefix/lib/$loaded"
ln -sf "$loaded" "$prefix/lib/$linked"
fill() {
    sed -e "s|@VERSION@|$version|g" -e "s|@LOADED@|$loaded|g" -e "s|@SONAME@|$soname|g" "$here/cmake/$1.in" \
        >"$prefix/lib/$2/$1"
}
fill colltrans.pc pkgconfig
fill colltransConfig.cmake cmake/colltrans
fill colltransConfigVersion.cmake cmake/colltrans
echo "installed colltrans $version in $prefix"
