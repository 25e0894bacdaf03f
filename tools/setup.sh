# shellcheck shell=bash
# What ./dev installs, and how; each function does nothing when all is there. Sourced by ./dev, uses its say and fail.
setup=1  # 0: --no-setup
apt_sources=/etc/apt

as_root() {
    if ((EUID == 0)); then
        "$@"
    elif command -v sudo >/dev/null; then
        sudo -- "$@"
    else
        fail "installing packages needs root or sudo; or install these by hand and use ./dev --no-setup: ${*: -1}" 2
    fi
}

apt() { as_root env DEBIAN_FRONTEND=noninteractive apt-get -o DPkg::Lock::Timeout=300 "$@" </dev/null >>build/setup.log 2>&1; }

# package_names GROUP...: the names below [GROUP] in packages.txt; all of them without a group.
package_names() {
    local group known
    known=$(sed -n 's/^\[\(.*\)\]$/\1/p' packages.txt)
    for group in "$@"; do
        grep -qx -- "$group" <<<"$known" || fail "packages: unknown group '$group'; there are: ${known//$'\n'/ }"
    done
    awk -v wanted=" $* " '
        { sub(/#.*/, "") }
        /^\[/ { group = substr($1, 2, length($1) - 2); next }
        NF && (wanted == "  " || index(wanted, " " group " ")) && !seen[$1]++ { print $1 }' packages.txt
}

setup_packages() {
    ((setup)) || return 0
    command -v apt-get >/dev/null || { say "no apt-get here: packages.txt names what is needed"; return 0; }
    local wanted missing
    wanted=$(package_names "$@")
    # shellcheck disable=SC2086 # one argument a line
    missing=$(comm -23 <(sort <<<"$wanted") \
        <(dpkg-query -W -f '${db:Status-Status} ${Package}\n' $wanted 2>/dev/null | sed -n 's/^installed //p' | sort -u))
    [[ -n $missing ]] || return 0
    mkdir -p build
    say "installing (log: build/setup.log): ${missing//$'\n'/ }"
    # The lists may be missing or older than the mirror: fetch them only if it does not go without.
    # shellcheck disable=SC2086
    apt install -y --no-install-recommends $missing || {
        apt update || say "apt-get update failed"
        apt install -y --no-install-recommends $missing ||
            { tail -n 15 build/setup.log >&2; fail "apt-get could not install: ${missing//$'\n'/ }" 2; }
    }
}

# backports_source: bookworm-backports as a deb822 stanza, from the mirror and the key that the machine's own sources name.
backports_source() {
    local file
    for file in "$apt_sources"/sources.list.d/*.sources; do
        [[ -f $file && $file != */lampyris-backports.sources ]] || continue
        awk '
            function flush() {
                if (suites ~ /(^| )bookworm( |$)/ && types ~ /(^| )deb( |$)/ && off != "no")
                    { print "Types: deb\nURIs: " uris "\nSuites: bookworm-backports\nComponents: main" (key == "" ? "" : "\nSigned-By:" key); found = 1; exit }
                suites = types = uris = key = off = ""
            }
            /^#/ { next }
            /^[ \t]*$/ { flush(); next }
            /^[ \t]/ { if (field == "signed-by") key = key "\n" $0; next }
            { field = tolower($1); sub(/:.*/, "", field); value = $0; sub(/^[^:]*:[ \t]*/, "", value) }
            field == "suites" { suites = value }
            field == "types" { types = value }
            field == "uris" { uris = value }
            field == "enabled" { off = tolower(value) }
            field == "signed-by" { key = value == "" ? "" : " " value }
            END { if (!found) flush() }' "$file" | grep . && return 0
    done
    for file in "$apt_sources"/sources.list "$apt_sources"/sources.list.d/*.list; do
        [[ -f $file ]] || continue
        awk '
            $1 == "deb" {
                key = ""; at = 2
                if ($2 ~ /^\[/) for (;; ++at) {
                    option = $at; gsub(/[][]/, "", option)
                    if (option ~ /^signed-by=/) key = substr(option, 11)
                    if ($at ~ /\]$/) { ++at; break }
                    if (at > NF) next
                }
                if ($(at + 1) != "bookworm") next
                print "Types: deb\nURIs: " $at "\nSuites: bookworm-backports\nComponents: main" (key == "" ? "" : "\nSigned-By: " key)
                exit
            }' "$file" | grep . && return 0
    done
    return 1
}

mesa_version() { dpkg-query -W -f '${Version}' mesa-vulkan-drivers 2>/dev/null || echo 0; }

# Mesa 25's lavapipe is three times as fast as bookworm's 22.3 and can trace rays itself. Everything works on both.
setup_mesa() {
    ((setup)) || return 0
    command -v dpkg >/dev/null || return 0
    dpkg --compare-versions "$(mesa_version)" lt 24 || return 0
    local tried=build/.mesa-backports-tried
    [[ -z $(find "$tried" -mtime -1 2>/dev/null) ]] || return 0  # asked within a day: do not ask on every run
    mkdir -p build
    say "installing Mesa from bookworm-backports (log: build/setup.log)"
    if ! apt install -y --no-install-recommends -t bookworm-backports mesa-vulkan-drivers; then
        local source=$apt_sources/sources.list.d/lampyris-backports.sources
        if backports_source >build/backports.sources && as_root install -m 644 build/backports.sources "$source" &&
            apt update && apt install -y --no-install-recommends -t bookworm-backports mesa-vulkan-drivers; then
            :
        else
            as_root rm -f "$source"
        fi
    fi
    if dpkg --compare-versions "$(mesa_version)" lt 24; then
        touch "$tried"
        say "Mesa $(mesa_version) stays: bookworm-backports cannot be reached. Vulkan works, about three times slower."
    fi
}

setup_venv() {
    ((setup)) || return 0
    cmp -s requirements.txt build/venv/requirements.txt && return 0
    setup_packages test
    say "making the Python environment build/venv (log: build/setup.log)"
    rm -rf build/venv
    mkdir -p build
    if ! { /usr/bin/python3 -m venv build/venv &&
        build/venv/bin/python -m pip install --quiet --require-hashes -r requirements.txt; } >>build/setup.log 2>&1; then
        tail -n 15 build/setup.log >&2
        fail "the Python environment could not be made" 2
    fi
    cp requirements.txt build/venv/requirements.txt  # last: it marks the environment as complete
}
