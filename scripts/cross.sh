# Cargo for other systems, for the scripts in this folder, which source it from the project's root.
# shellcheck shell=bash
#
# The standard library of a target is built from Debian's rust-web-src by its rustc-web where both
# are installed, without the symbols of backtraces, which makes a library an eighth smaller; otherwise
# it is that of rustup, which the scripts add. The linker is zig's, from the Python package index, or
# mingw's for Windows.

CROSS_TOOLS=.tools/cross
# Versions that are known to build the same bytes.
CROSS_PACKAGES=(cargo-zigbuild==0.24.0 ziglang==0.17.0 maturin==1.16.0)
# The compiler with the sources of its standard library.
DEBIAN_PACKAGES=(rustc-web cargo-web rust-web-src)
LLVM_PACKAGE=llvm-14
# The oldest C library that the Linux libraries run with, and the oldest macOS.
GLIBC=2.17
export MACOSX_DEPLOYMENT_TARGET=11.0

# Prints the targets of Rust that a platform needs.
targets_of() { # PLATFORM
    case $1 in
    linux64) echo x86_64-unknown-linux-gnu ;;
    aarch64-linux) echo aarch64-unknown-linux-gnu ;;
    win64) echo x86_64-pc-windows-gnu ;;
    aarch64-darwin) echo aarch64-apple-darwin ;;
    darwin64) echo aarch64-apple-darwin x86_64-apple-darwin ;;
    *) fail "no platform $1" "Name linux64, win64, darwin64, aarch64-linux or aarch64-darwin." ;;
    esac
}

# Gets what building for platforms needs, and nothing that they do not: linkers, and the standard
# library of each target.
cross_setup() { # PLATFORM...
    local platform target targets=()
    for platform in "$@"; do
        target=$(targets_of "$platform") || exit
        # shellcheck disable=SC2206
        targets+=($target)
    done
    if ! [ -x "$CROSS_TOOLS/bin/maturin" ]; then
        say "installing ${CROSS_PACKAGES[*]} in $CROSS_TOOLS"
        python3 -m venv "$CROSS_TOOLS" && "$CROSS_TOOLS/bin/pip" install --quiet "${CROSS_PACKAGES[@]}" ||
            fail "cannot install ${CROSS_PACKAGES[*]}" "Check the network, and that Python has venv."
    fi
    get_standard_libraries "${targets[@]}"
    case " $* " in *' win64 '*)
        has x86_64-w64-mingw32-gcc || { can_apt && apt_install gcc-mingw-w64-x86-64-win32; } ||
            fail "no linker for Windows" "Install mingw-w64 (Debian: gcc-mingw-w64-x86-64-win32)."
        ;;
    esac
    case " $* " in *darwin*)
        [ -n "$(lld_program)" ] || { can_apt && apt_install lld; } ||
            fail "no linker for macOS" "Install lld, or Rust by rustup."
        ;;
    esac
    case " $* " in *' darwin64 '*)
        [ -n "$(lipo_program)" ] || { can_apt && apt_install "$LLVM_PACKAGE"; } ||
            fail "no lipo to join the libraries of macOS" "Install LLVM (Debian: $LLVM_PACKAGE)."
        ;;
    esac
}

# Gets the standard libraries of targets that are not there: Debian's sources on Debian, otherwise
# those of rustup.
get_standard_libraries() { # TARGET...
    local target missing=()
    [ -z "$(std_sources)" ] || return 0
    for target in "$@"; do
        has_target "$target" || missing+=("$target")
    done
    [ ${#missing[@]} -gt 0 ] || return 0
    if can_apt && apt_install "${DEBIAN_PACKAGES[@]}"; then
        return
    fi
    say "adding ${missing[*]} with rustup"
    has rustup && rustup target add "${missing[@]}" ||
        fail "no Rust standard library for ${missing[*]}" "Run: rustup target add ${missing[*]}" \
            "or install Debian's ${DEBIAN_PACKAGES[*]}."
}

# Prints the program that joins libraries of several processors, nothing if there is none.
lipo_program() {
    local lipo
    for lipo in lipo llvm-lipo llvm-lipo-14; do
        ! has "$lipo" || { echo "$lipo" && return; }
    done
}

# Makes a folder with what lld needs to know of macOS. zig's libSystem names processors that lld does
# not know; those of Apple silicon have the same symbols.
macos_libraries() { # FOLDER
    local name
    mkdir -p "$1/usr/lib"
    sed -E 's/arm64e(\.x1)?-/arm64-/g' \
        "$CROSS_TOOLS"/lib/python3*/site-packages/ziglang/lib/libc/darwin/libSystem.tbd >"$1/usr/lib/libSystem.tbd"
    for name in c m; do
        ln -sf libSystem.tbd "$1/usr/lib/lib$name.tbd"
    done
    # The standard library names it and does not use it.
    printf '%s\n' '--- !tapi-tbd' 'tbd-version: 4' 'targets: [ x86_64-macos, arm64-macos ]' \
        'install-name: /usr/lib/libiconv.2.dylib' '...' >"$1/usr/lib/libiconv.tbd"
}

# Prints the folder of the sources of Debian's standard library, nothing if they or its cargo are
# not there.
std_sources() {
    local folder
    folder=$(echo /usr/src/rustc-*)
    [ ! -x /usr/bin/cargo ] || [ ! -f "$folder/library/Cargo.lock" ] || printf '%s\n' "$folder"
}

# Whether rustup's compiler has the standard library of a target.
has_target() { [ -d "$(rustc --print sysroot)/lib/rustlib/$1/lib" ]; }

# Prints cargo's folder: that of Debian's compiler or that of rustup's.
cross_folder() {
    if [ -n "$(std_sources)" ]; then echo "$CARGO_TARGET_DIR/cross"; else echo "$CARGO_TARGET_DIR/portable"; fi
}

# Runs a builder, `cargo zigbuild` or `maturin build --zig`, for a target, such that what it builds
# has no paths of this machine.
cross_build() ( # BUILDER TARGET ARGUMENT...
    local builder=$1 target=$2 flags='' folder
    shift 2
    unset RUSTFLAGS CARGO_ENCODED_RUSTFLAGS
    # Only tests need the standard's headers.
    export BIELA_FMI_HEADERS=
    local rustc=rustc sources build_std=() directory lld
    # Before Debian's compiler comes first on the path.
    lld=$(lld_program)
    directory=$(cross_folder)
    sources=$(std_sources)
    if [ -n "$sources" ]; then
        rustc=/usr/bin/rustc
        export RUSTC=$rustc RUSTDOC=/usr/bin/rustdoc RUSTC_BOOTSTRAP=1
        PATH=/usr/bin:$PATH
        build_std=(-Zbuild-std=std,panic_unwind
            -Zbuild-std-features=panic-unwind,optimize_for_size)
    fi
    export CARGO_TARGET_DIR=$directory PATH=$PWD/$CROSS_TOOLS/bin:$PATH
    # maturin adds to these; it would put its own in place of those of a configuration.
    flag() { flags+="${flags:+$'\x1f'}$1"; }
    for folder in "${CARGO_HOME:-$HOME/.cargo}"/registry/src/*; do
        flag "--remap-path-prefix=$folder=crates"
    done
    [ -z "$sources" ] || flag "--remap-path-prefix=$sources=rust"
    flag "--remap-path-prefix=$PWD=biela"
    # A tenth smaller; the solver is as fast, as it names what has to be inline.
    flag "-Cllvm-args=-inline-threshold=100"
    local named=$target
    case $target in
    *-linux-gnu) [ "$builder" != 'cargo zigbuild' ] || named=$target.$GLIBC ;;
    *-apple-darwin)
        # Stripped by the linker: its signature comes after.
        export CARGO_PROFILE_RELEASE_STRIP=none MATURIN_STRIP=false
        if [ "$builder" = 'cargo zigbuild' ]; then
            builder='cargo build'
            export SDKROOT=$CARGO_TARGET_DIR/macos
            macos_libraries "$SDKROOT"
            flag "-Clinker=$lld"
            flag "-Clinker-flavor=ld64.lld"
            flag "-Clink-args=-S -x -dead_strip_dylibs -install_name @rpath/biela.dylib"
        else
            export SDKROOT=$CARGO_TARGET_DIR
            flag "-Clink-arg=-Wl,-s"
            flag "-Clink-arg=-Wl,-install_name,@rpath/biela.dylib"
        fi
        ;;
    *-windows-gnu)
        local objects=$CARGO_TARGET_DIR/windows-crt
        export CARGO_TARGET_X86_64_PC_WINDOWS_GNU_LINKER=x86_64-w64-mingw32-gcc
        flag "-Clink-arg=-Wl,--no-insert-timestamp"
        if [ -n "$sources" ]; then
            # The only objects that building the standard library leaves out.
            mkdir -p "$objects"
            for folder in rsbegin rsend; do
                "$rustc" --target "$target" --emit=obj -o "$objects/$folder.o" \
                    "$sources/library/rtstartup/$folder.rs"
            done
            flag "-L$objects"
        fi
        # mingw links instead of zig.
        builder=${builder/zigbuild/build}
        builder=${builder/ --zig/}
        ;;
    esac
    export CARGO_ENCODED_RUSTFLAGS=$flags
    # shellcheck disable=SC2086
    $builder --release --locked --target "$named" "${build_std[@]}" "$@"
)

# Prints the path of what cross_build has built for a target.
cross_built() { # TARGET FILE
    printf '%s\n' "$(cross_folder)/$1/release/$2"
}
