#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
set -euo pipefail

usage() {
  cat <<'TEXT'
usage: tools/arm64_vcan.sh [OPTION...] [--] DIR COMMAND [ARG...]

Runs a command on Debian's arm64 kernel in QEMU, an emulated machine with two Cortex-A72, where a
real SocketCAN interface vcan0 exists and the loopback is up. The working folder there is a copy of
DIR (static aarch64 programs, scripts, data) in memory: files written there are lost. It contains
busybox and candump, and nothing else. Exit status, standard output and standard error are the
command's, which runs as root with an empty standard input. Starting takes some five seconds.

  --interfaces N   vcan0 to vcan<N-1> (default 1)
  --memory SIZE    memory of the machine, such as 512M or 2G (default 1G)
  --own-clock      its clocks advance with the instructions it executes, not with the host's clock:
                   a nanosecond per instruction, and idle time is skipped. So a busy host cannot make
                   it late, but one of its seconds may take any time. One core
  --bring-back NEW when the command has ended, the folder `out` of its working folder becomes NEW,
                   which must not exist yet
  --timeout S      ends everything after S seconds, including the start, with exit status 124
  --verbose        also shows the kernel's log
  --help           this text

The kernel and these programs are downloaded once from Debian's archive with apt-get download into
$XDG_CACHE_HOME/hardpack/arm64_vcan (default ~/.cache), which may be deleted at any time.

Exit status: the command's; 2 bad usage, 123 the machine failed, 124 time-out and 125 something
required is missing, each with its reason on standard error. SIGTERM, SIGINT and SIGHUP end
everything at once.
TEXT
}

end_with() {
  local status=$1
  shift
  echo "arm64_vcan.sh: $*" >&2
  exit "$status"
}

interfaces=1
memory=1G
own_clock=false
back=
timeout=infinity
verbose=false
while [ $# -gt 0 ]; do
  case $1 in
    --interfaces | --memory | --timeout)
      [ $# -ge 2 ] || end_with 2 "$1 needs a value; see --help"
      declare "${1#--}=$2"
      shift
      ;;
    --bring-back)
      [ $# -ge 2 ] || end_with 2 "$1 needs a value; see --help"
      back=$2
      shift
      ;;
    --own-clock) own_clock=true ;;
    --verbose) verbose=true ;;
    --help | -h) usage; exit 0 ;;
    --) shift; break ;;
    -*) end_with 2 "unknown option $1; see --help" ;;
    *) break ;;
  esac
  shift
done
[[ $interfaces =~ ^[1-9][0-9]?$ ]] || end_with 2 "--interfaces is a number from 1 to 99"
[[ $memory =~ ^[1-9][0-9]*[MG]$ ]] || end_with 2 "--memory is a number and M or G"
[[ $timeout =~ ^([0-9]+(\.[0-9]+)?|infinity)$ ]] || end_with 2 "--timeout is a number of seconds"
if [ -n "$back" ] && [ -e "$back" ]; then end_with 2 "$back already exists"; fi
[ $# -ge 2 ] || end_with 2 "DIR and COMMAND are required; see --help"
[ -d "$1" ] || end_with 2 "$1 is not a folder"
folder=$1
shift

for program in qemu-system-aarch64 cpio; do
  command -v $program >/dev/null || end_with 125 "packages qemu-system-arm and cpio are needed"
done

work=
machine=
clock=
readers=()
# shellcheck disable=SC2317
end_all() {
  local pid
  trap '' TERM INT HUP
  exec 2>/dev/null  # Bash would say of each that it was killed.
  for pid in $machine $clock "${readers[@]}"; do kill -KILL "$pid" || true; done
  wait || true
  if [ -n "$work" ]; then rm -rf "$work"; fi
}
trap end_all EXIT
trap 'exit 143' TERM
trap 'exit 130' INT
trap 'exit 129' HUP
work=$(mktemp -d "${TMPDIR:-/tmp}/arm64_vcan.XXXXXX")

# --- the kernel and the busybox -------------------------------------------------------------------

cache=${XDG_CACHE_HOME:-$HOME/.cache}/hardpack/arm64_vcan
modules=(net/can/can net/can/can-raw drivers/net/can/dev/can-dev drivers/net/can/vcan
  drivers/virtio/virtio_pci_legacy_dev drivers/virtio/virtio_pci_modern_dev
  drivers/virtio/virtio_pci drivers/block/virtio_blk)

# Of Debian's arm64 packages, whatever this machine's own are: only the few files that are used are
# kept. The folder is filled aside and moved into place whole; of two at a time the later wins.
fetch() {
  local lists=$work/lists apt kernel module package
  mkdir -p "$lists/partial" "$work/debs" "$work/unpacked" "$work/cache"
  apt=(-o APT::Architecture=arm64 -o APT::Architectures=arm64 -o Dir::State::Lists="$lists"
    -o Dir::Cache="$work" -o APT::Sandbox::User="$(id -un)" -o Debug::NoLocking=1)
  apt-get "${apt[@]}" -qq update
  kernel=$(apt-cache "${apt[@]}" depends linux-image-arm64 | awk '/Depends:/ { print $2; exit }')
  (cd "$work/debs" && apt-get "${apt[@]}" -qq download "$kernel" busybox-static can-utils libc6)
  for package in "$work"/debs/*.deb; do dpkg -x "$package" "$work/unpacked"; done
  cp "$work"/unpacked/boot/vmlinuz-* "$work/cache/vmlinuz"
  cp "$work/unpacked/bin/busybox" "$work/unpacked/usr/bin/candump" "$work/cache/"
  cp -L "$work"/unpacked/lib/aarch64-linux-gnu/{libc.so.6,ld-linux-aarch64.so.1} "$work/cache/"
  for module in "${modules[@]}"; do
    cp "$work"/unpacked/lib/modules/*/kernel/"$module.ko" "$work/cache/"
  done
  mkdir -p "$(dirname "$cache")"
  rm -rf "$cache"
  mv -T "$work/cache" "$cache"
}

if [ ! -e "$cache/candump" ]; then  # the newest of its files
  set +e  # on the left of || the first failure would not end it
  (set -e; fetch) >"$work/fetch.log" 2>&1 </dev/null
  fetched=$?
  set -e
  if [ $fetched -ne 0 ]; then
    tail -n 5 "$work/fetch.log" >&2
    end_with 125 "Debian's arm64 kernel, busybox and candump could not be fetched"
  fi
fi

# --- the machine ----------------------------------------------------------------------------------

# Its first file system is all it has. A card with four serial ports takes out what the command
# prints, apart from the console.
make_file_system() {
  local module
  mkdir -p "$work/fs"/{bin,dev,lib,modules,proc,run/app,sys,tmp}
  cp "$cache/busybox" "$cache/candump" "$work/fs/bin/"
  cp "$cache/libc.so.6" "$cache/ld-linux-aarch64.so.1" "$work/fs/lib/"
  cp -a "$folder/." "$work/fs/run/app/"
  for module in "${modules[@]}"; do cp "$cache/${module##*/}.ko" "$work/fs/modules/"; done
  { printf 'exec'; printf " '%s'" "${@//\'/\'\\\'\'}"; } >"$work/fs/command"
  cat >"$work/fs/init" <<INIT
#!/bin/busybox sh
set -e
/bin/busybox --install -s /bin
export PATH=/bin HOME=/tmp
mount -t proc proc /proc
mount -t sysfs sysfs /sys
mount -t devtmpfs devtmpfs /dev
mkdir /dev/shm
mount -t tmpfs tmpfs /dev/shm
ln -s /proc/self/fd /dev/fd
for module in ${modules[*]##*/}; do insmod /modules/\$module.ko; done
ip link set lo up
for i in \$(seq 0 $((interfaces - 1))); do
  ip link add dev vcan\$i type vcan
  ip link set vcan\$i up
done
for port in 0 1 2; do stty -F /dev/ttyS\$port raw -echo; done
cd /run/app
set +e
{
  {
    sh /command </dev/null 2>&1 >&3 3>&-
    echo \$? >/status
  } | cat >/dev/ttyS1
} 3>&1 | cat >/dev/ttyS0
if [ -b /dev/vda ] && [ -d out ]; then tar -c -f /dev/vda out || echo failed >/status; fi
cat /status >/dev/ttyS2
poweroff -f
INIT
  chmod +x "$work/fs/init"
  (cd "$work/fs" && find . | cpio -o -H newc --quiet | gzip -1) >"$work/initrd"
}

bound=(setpriv --pdeathsig KILL)  # a child that is killed when this script is, by whatever signal
make_file_system "$@"
mkfifo "$work/output" "$work/errors"
"${bound[@]}" cat "$work/output" &
readers+=($!)
"${bound[@]}" cat "$work/errors" >&2 &
readers+=($!)
options=(-smp 2)
# Neither TCG thread nor sleep between instructions: the machine's time goes on by 2^0 ns for each.
if $own_clock; then options=(-smp 1 -icount "shift=0,sleep=off"); fi
if [ -n "$back" ]; then
  truncate -s "$memory" "$work/disk"  # a file with a hole: more than its memory it cannot hold
  options+=(-drive "file=$work/disk,format=raw,if=none,id=disk,cache=unsafe"
    -device "virtio-blk-pci,drive=disk")
fi
"${bound[@]}" qemu-system-aarch64 -M virt -cpu cortex-a72 "${options[@]}" -m "$memory" -display none \
  -no-reboot -nic none -kernel "$cache/vmlinuz" -initrd "$work/initrd" \
  -append "console=ttyAMA0 panic=-1" -serial "file:$work/log" \
  -chardev "file,id=output,path=$work/output" -chardev "file,id=errors,path=$work/errors" \
  -chardev "file,id=status,path=$work/status" -chardev null,id=none \
  -device pci-serial-4x,chardev1=output,chardev2=errors,chardev3=status,chardev4=none \
  </dev/null >"$work/qemu.log" 2>&1 &
machine=$!
"${bound[@]}" sleep "$timeout" &
clock=$!

while true; do
  status=0
  wait -n -p ended || status=$?
  case $ended in
    "$machine") break ;;
    "$clock") end_with 124 "ended after $timeout s" ;;
    *) [ $status -eq 0 ] || exit 141 ;;  # by a broken pipe; without an error the machine has ended
  esac
done
wait "${readers[@]}" || exit 141
status=$(grep -x '[0-9]*' "$work/status") || status=failed
if $verbose || [ "$status" = failed ]; then cat "$work/qemu.log" "$work/log" >&2; fi
if [ "$status" = failed ]; then end_with 123 "the machine failed; above is its log"; fi
if [ -n "$back" ]; then
  mkdir "$work/back"
  tar -x -f "$work/disk" -C "$work/back" || end_with 123 "the folder out is too large"
  [ -d "$work/back/out" ] || end_with 123 "the command left no folder out"
  mv -T "$work/back/out" "$back"
fi
exit "$status"
