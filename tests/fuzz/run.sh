#!/usr/bin/env bash
# Fuzzes everything that reads bytes of strangers, each target for its share of SECONDS (default 60); exit status 0: nothing
# was found. What is found is left in build/fuzz/found/. Needs the presets dev (chamferprep makes sidecars) and fuzz:
#   tests/fuzz/run.sh [SECONDS [TARGET...]]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

seconds="${1:-60}"
targets=("${@:2}")
[ "${#targets[@]}" -gt 0 ] || targets=(sidecar request ray_list scene mesh)

seed_sidecar() {
  for mesh in data/solids/*.obj data/bricks/*.obj; do
    build/dev/preprocess/chamferprep "$mesh" --radius 1% --quiet -o "$1/$(basename "$mesh").chamfer"
  done
}

seed_request() {
  local n=0 query
  for query in "" "?camera=3,-3,2,0,0,0,0,0,1,40" "?camera=3,-3,2,0,0,0,0,0,1,40,0.1,4&seed=7&bounces=2" \
    "?rounding=none" "?rounding=mesh:3&radius=0.05" "?rounding=bevel%3A4&radius=1e-3&aov=normal"; do
    printf '/v1/scenes/abc/tiles/640x480/0,0,64,64/0-16.f16%s' "$query" >"$1/tile-$n"
    printf '/v1/scenes/a%%2Fb/frames/640x480/0-16.png%s' "$query" >"$1/frame-$n"
    printf 'GET /v1/scenes/abc/tiles/64x64/0,0,8,8/0-1.exr%s HTTP/1.1\r\nHost: a\r\nConnection: close\r\n\r\n' "$query" >"$1/head-$n"
    n=$((n + 1))
  done
  printf 'POST /v1/scenes/abc/rays HTTP/1.1\r\nHost: a\r\nContent-Type: application/json\r\nContent-Length: 11\r\nExpect: 100-continue\r\n\r\n{"rays":[]}' >"$1/post"
}

seed_ray_list() {
  printf '{"rays":[[0,0,5,0,0,-1],[3,-3,0.1,-1,1,0]],"rounding":"analytic","radius":0.05,"tnear":0.5}' >"$1/full"
  printf '{"rays":[],"rounding":"none"}' >"$1/empty"
  printf '{"tnear":1e-3,"rays":[[1e30,-1E+2,-0.0,1e-3,0.25,7]],"rounding":"mesh:2"}' >"$1/numbers"
}

seed_scene() { cp data/*.scene.json "$1/"; }

# The first byte chooses the format: '@' OBJ, 'A' STL, 'B' PLY, 'C' OFF.
seed_mesh() {
  local mesh
  for mesh in data/solids/*.obj; do
    { printf '@' && cat "$mesh"; } >"$1/$(basename "$mesh")"
  done
  { printf '@' && cat data/stage/room.obj && printf '\n#MTL\n' && cat data/stage/room.mtl; } >"$1/room.obj"
  printf 'Asolid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\n' >"$1/a.stl"
  { printf 'A%80s\1\0\0\0' '' && head -c 50 /dev/zero; } >"$1/b.stl"
  printf 'Bply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n' >"$1/a.ply"
  { printf 'Bply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n' &&
    head -c 36 /dev/zero && printf '\3\0\0\0\0\1\0\0\0\2\0\0\0'; } >"$1/b.ply"
  printf 'COFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n' >"$1/a.off"
}

mkdir -p build/fuzz/found
for target in "${targets[@]}"; do
  corpus="build/fuzz/corpus/$target"
  mkdir -p "$corpus"
  "seed_$target" "$corpus"
  dictionary="tests/fuzz/$target.dict"
  options=(-max_total_time=$((seconds / ${#targets[@]})) -timeout=10 -rss_limit_mb=4096 -artifact_prefix=build/fuzz/found/)
  [ ! -e "$dictionary" ] || options+=(-dict="$dictionary")
  echo "-- $target"
  log="build/fuzz/$target.log"
  if ! "build/fuzz/tests/fuzz_$target" "$corpus" "${options[@]}" -print_final_stats=1 >"$log" 2>&1; then
    tail -n 60 "$log"
    exit 1
  fi
  grep -E "DONE|number_of_executed_units|peak_rss" "$log" | tail -n 3
done
