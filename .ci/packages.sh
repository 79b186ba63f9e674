# Sourced by ./start and ./check: install_packages installs what packages.txt lists and this machine lacks, up to its line
# "# tests" unless the second argument is "tests". On other systems than Debian 12 nothing is installed. Needs machine.sh.

# Prints the packages of a list (file $1) that are not installed, one a line.
missing_packages() {
  local line package command
  while IFS= read -r line; do
    case "$line" in "# tests"*) [ "${2:-}" = tests ] || return 0 ;; esac
    line="${line%%#*}"
    line="${line//[[:space:]]/}"
    [ -n "$line" ] || continue
    package="${line%%:*}"
    command=""
    case "$line" in *:*) command="${line#*:}" ;; esac
    if [ -n "$command" ] && command -v "$command" >/dev/null; then continue; fi
    if [ "$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null)" = installed ]; then continue; fi
    printf '%s\n' "$package"
  done <"$1"
}

install_packages() {
  local list="$1" part="${2:-}" packages=() as_root=()
  if ! is_debian_12; then # it may have all that is needed, and says so only if it has not
    trap 'status=$?; [ "$status" -eq 0 ] || other_system_advice "$(basename "$0")" .ci/packages.txt' EXIT
    return 0
  fi
  mapfile -t packages < <(missing_packages "$list" "$part")
  [ "${#packages[@]}" -gt 0 ] || return 0

  echo "Installing ${#packages[@]} missing packages: ${packages[*]}"
  if [ "$(id -u)" -ne 0 ]; then
    if ! command -v sudo >/dev/null; then
      echo "error: not root and no sudo; run as root: apt-get install ${packages[*]}" >&2
      return 1
    fi
    as_root=(sudo)
  fi
  "${as_root[@]}" apt-get update -q </dev/null
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
    apt-get install -y -q --no-install-recommends "${packages[@]}" </dev/null
}
