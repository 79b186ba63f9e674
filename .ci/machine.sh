# Sourced by ./start and ./check: whether this machine can run Chamfer, said before minutes are spent on a build.

# Fails, with the reason, where the processor lacks what the programs and Embree are compiled for. $1: instead of /proc/cpuinfo.
check_processor() {
  local cpuinfo="${1:-/proc/cpuinfo}" flags missing=() flag
  flags=" $(sed -n '/^flags/{s/.*://p;q}' "$cpuinfo") "
  for flag in avx2 fma f16c bmi1 bmi2 movbe abm; do
    case "$flags" in *" $flag "*) ;; *) missing+=("$flag") ;; esac
  done
  [ "${#missing[@]}" -gt 0 ] || return 0
  echo "error: this processor lacks ${missing[*]}. Chamfer needs an x86-64 processor with AVX2: Intel's since Haswell (2013)," >&2
  echo "AMD's since Excavator (2015). In a virtual machine, pass the host's processor on (QEMU: -cpu host)." >&2
  return 1
}

# $1: instead of /etc/os-release.
is_debian_12() (
  . "${1:-/etc/os-release}" 2>/dev/null && [ "${ID:-}" = debian ] && [ "${VERSION_ID:-}" = 12 ]
)

# What to do on a system whose packages are others. $1: the script that was started; $2: the list of packages.
other_system_advice() {
  cat >&2 <<END

Chamfer is made for Debian 12, which this system is not; nothing was installed. Either run it in a container:

  docker run --rm -it -p 127.0.0.1:8080:8080 -v "\$PWD:/chamfer" -w /chamfer -e HOST=0.0.0.0 debian:12 ./$1$(
    [ "$1" = start ] && echo " --no-auth"
  )

or install by hand what $2 names, in the versions of Debian 12 (https://packages.debian.org/bookworm/): Embree 3,
OpenImageIO 2.4, CGAL 5.5, OpenMesh 9, GCC 12. A build/ that was made by another system must be deleted first.
END
}

in_container() {
  [ -e /.dockerenv ] || [ -e /run/.containerenv ] || [ -n "${container:-}" ]
}
