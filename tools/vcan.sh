#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
set -euo pipefail

usage() {
  cat <<'TEXT'
usage: tools/vcan.sh [OPTION...] [--] COMMAND [ARG...]

Runs a command where a real SocketCAN interface vcan0 exists and the loopback is up, in its own
network: nothing else is reachable, and parallel runs do not see each other. Its exit status, standard
output and standard error are the command's, which runs as root, in this folder, with this
environment and an empty standard input; processes that the command leaves behind are ended with it.

  host  if this machine's kernel can create a vcan: in separate name spaces
  uml   otherwise: in Debian's User-Mode Linux kernel (package user-mode-linux), which boots in about
        three seconds with this file system as its own: one CPU (it stays on the last that this script
        may use), system calls some ten times slower.
        Files written there are certain to be on the disk when the command has ended, not before.
        Programs with an address or thread sanitizer do not start there

  --interfaces N   vcan0 to vcan<N-1> (default 1)
  --memory SIZE    memory of the User-Mode Linux machine, such as 512M or 2G (default 1G)
  --realtime       lets the User-Mode Linux machine go before this computer's other programs (a nice
                   value of -20), so that its clock ticks in time on a busy host; writing to files
                   shared with the host still stops the whole machine: write to /dev/shm
  --timeout S      ends everything after S seconds, including the start, with exit status 124
  --way host|uml   uses that way or fails
  --verbose        shows the User-Mode Linux kernel's log on standard error at the end, whatever the
                   outcome; otherwise only when the machine failed
  --which          only prints the way that it would use: host or uml
  --help           this text

Exit status: the command's; 2 bad usage, 123 the User-Mode Linux machine failed, 124 time-out and
125 no way to create a vcan, each with its reason on standard error; 141 if the reader of the output
is gone. SIGTERM, SIGINT and SIGHUP end everything at once; so does SIGKILL, but it leaves a small
folder in /tmp and, if run by a user other than root, two sleeping processes.
TEXT
}

no_way() {
  echo "vcan.sh: $*" >&2
  exit 125
}

bad_usage() {
  echo "vcan.sh: $*; see --help" >&2
  exit 2
}

interfaces=1
memory=1G
timeout=infinity
realtime=false
way=
verbose=false
only_which=false
while [ $# -gt 0 ]; do
  case $1 in
    --interfaces | --memory | --timeout | --way)
      [ $# -ge 2 ] || bad_usage "$1 needs a value"
      declare "${1#--}=$2"
      shift
      ;;
    --realtime) realtime=true ;;
    --verbose) verbose=true ;;
    --which) only_which=true ;;
    --help | -h) usage; exit 0 ;;
    --) shift; break ;;
    -*) bad_usage "unknown option $1" ;;
    *) break ;;
  esac
  shift
done
[[ $interfaces =~ ^[1-9][0-9]?$ ]] || bad_usage "--interfaces is a number from 1 to 99"
[[ $memory =~ ^[1-9][0-9]*[MG]$ ]] || bad_usage "--memory is a number and M or G"
[[ $timeout =~ ^([0-9]+(\.[0-9]+)?|infinity)$ ]] || bad_usage "--timeout is a number of seconds"
[[ $way =~ ^(host|uml)?$ ]] || bad_usage "--way is host or uml"
$only_which || [ $# -gt 0 ] || bad_usage "there is no command"
PATH=$PATH:/usr/sbin:/sbin

# --- the two ways ---------------------------------------------------------------------------------

# Both ways run this first.
# shellcheck disable=SC2016
make_interfaces='
ip link set lo up
for ((i = 0; i < interfaces; i++)); do
  ip link add dev "vcan$i" type vcan
  ip link set "vcan$i" up
done'

# A process-id name space ends with its first process, and so does all that was started in it. /sys
# shows the interfaces of the network that it was mounted in.
name_spaces=(unshare --net --mount --pid --fork --kill-child --mount-proc)
if [ "$(id -u)" -ne 0 ]; then name_spaces+=(--map-root-user); fi
host_init="set -e; interfaces=$interfaces; mount -t sysfs sysfs /sys; $make_interfaces"

# Runs a command as the second process of a name space: the first is spared the signals that should
# end it.
# shellcheck disable=SC2016
run='"$@" </dev/null; exit $?'

host_can() {
  command -v unshare >/dev/null && "${name_spaces[@]}" bash -c "$host_init" &>/dev/null
}

uml_modules=/usr/lib/uml
uml_can() {
  local program
  for program in linux.uml modprobe ip; do command -v $program >/dev/null || return; done
  [ -d "$uml_modules/modules" ]
}

case $way in
  host) host_can || no_way "this machine's kernel cannot make a vcan for this user" ;;
  uml) uml_can || no_way "packages user-mode-linux, kmod and iproute2 are needed" ;;
  *)
    if host_can; then
      way=host
    elif uml_can; then
      way=uml
    else
      no_way "this machine's kernel cannot make a vcan, and packages user-mode-linux, kmod and" \
        "iproute2 are not all installed"
    fi
    ;;
esac
if $only_which; then
  echo "$way"
  exit 0
fi

# --- the machine: one process, everything else its children ---------------------------------------

work=
machine=
clock=
readers=()  # of the User-Mode Linux machine's output
# shellcheck disable=SC2317
end_all() {
  local pid
  trap '' TERM INT HUP
  exec 2>/dev/null  # Bash would say of each that it was killed.
  # The machine leads a session of its own, so that no process of it is missed.
  for pid in ${machine:+"-$machine"} $clock "${readers[@]}"; do kill -KILL -- "$pid" || true; done
  wait || true
  # Processes of the machine whose parent was killed with them are no children of this script, and a
  # busy host takes a while to give their memory back. Not for ever: a host's first process may
  # never bury them.
  for _ in {1..200}; do
    if [ -z "$machine" ] || ! kill -0 -- "-$machine"; then break; fi
    sleep 0.05
  done
  if [ -n "$work" ]; then rm -rf "$work"; fi
}
trap end_all EXIT
trap 'exit 143' TERM
trap 'exit 130' INT
trap 'exit 129' HUP
work=$(mktemp -d "${TMPDIR:-/tmp}/vcan.XXXXXX")

# A child that is killed when this script is, by whatever signal.
bound=(setpriv --pdeathsig KILL)

start_on_host() {
  setsid "${bound[@]}" "${name_spaces[@]}" bash -c "$host_init; set +e; $run" vcan.sh "$@" \
    </dev/null &
  machine=$!
}

# What the first process of the User-Mode Linux machine runs. The command's output goes through
# pipes, so that it is no terminal's, into consoles that this script reads from FIFOs.
write_guest() {
  {
    declare -px
    printf 'umask %s\ncd %q || exit 123\nexec ' "$(umask)" "$PWD"
    printf '%q ' "$@"
  } >"$work/command"
  cat >"$work/init" <<INIT
#!/bin/bash
set -e
export PATH=/usr/sbin:/usr/bin:/sbin:/bin
mount -t proc proc /proc
mount -t sysfs sysfs /sys
mkdir /dev/shm /dev/pts
mount -t tmpfs tmpfs /dev/shm
mount -t devpts devpts /dev/pts
ln -s /proc/self/fd /dev/fd
ln -s /proc/self/fd/0 /dev/stdin
ln -s /proc/self/fd/1 /dev/stdout
ln -s /proc/self/fd/2 /dev/stderr
modprobe -d '$work' -a can-raw vcan
interfaces=$interfaces
$make_interfaces
stty -F /dev/tty1 raw -echo
stty -F /dev/tty2 raw -echo
set +e
{
  {
    env -i unshare --pid --fork --kill-child --mount-proc bash -c '$run' vcan.sh \
      bash '$work/command' 2>&1 >&3 3>&-
    echo \$? >'$work/status.new'
  } | cat >/dev/tty2
} 3>&1 | cat >/dev/tty1
mv '$work/status.new' '$work/status'
sync
echo o >/proc/sysrq-trigger
sleep 60
INIT
  chmod +x "$work/init"
  mkdir "$work/lib"
  ln -s "$uml_modules/modules" "$work/lib/modules"
}

# The folder that the machine's memory is a file of: /dev/shm where there is room for it.
memory_folder() {
  local room_kib need_kib
  room_kib=$(df --output=avail /dev/shm 2>/dev/null | tail -n 1) || room_kib=0
  need_kib=$(($(numfmt --from=iec "$memory") / 1024))
  if ((room_kib > need_kib)); then echo /dev/shm; else echo "$work"; fi
}

start_uml() {
  write_guest "$@"
  # Only root can have a name space for processes without one for users, in which the machine would
  # find root's files to be nobody's. Without, a SIGKILL of this script leaves two of its threads.
  local one_end=()
  if unshare --pid true 2>/dev/null; then one_end=(unshare --pid --fork --kill-child); fi
  # A real-time priority is worse: a machine that takes all of its processor then stands still for
  # 50 ms of each second, in which the kernel lets others have it.
  local first=()
  if $realtime; then
    if [ "$(nice -n -20 nice 2>/dev/null)" = -20 ]; then
      first=(nice -n -20)
    else
      echo "vcan.sh: no permission for a nice value of -20; going on without" >&2
    fi
  fi
  # It hands each system call from one of its processes to another and back: across two processors,
  # both are interrupted each time, and on a busy host that takes more time than the machine itself.
  local one_cpu=(taskset --cpu-list "$(sed -n 's/^Cpus_allowed_list:.*[^0-9]//p' /proc/self/status)")
  mkfifo "$work/output" "$work/errors"
  "${bound[@]}" cat "$work/output" &
  readers+=($!)
  "${bound[@]}" cat "$work/errors" >&2 &
  readers+=($!)
  TMPDIR=$(memory_folder) setsid "${bound[@]}" "${one_cpu[@]}" "${first[@]}" \
    "${one_end[@]}" bash -c "$run" vcan.sh linux.uml mem="$memory" uml_dir="$work/" rootfstype=hostfs \
    rootflags=/ rw init="$work/init" panic=1 con0=null,fd:1 con1=null,fd:3 con2=null,fd:4 \
    </dev/null >"$work/log" 2>&1 3>"$work/output" 4>"$work/errors" &
  machine=$!
}

if [ $way = host ]; then start_on_host "$@"; else start_uml "$@"; fi
"${bound[@]}" sleep "$timeout" &
clock=$!

while true; do
  status=0
  wait -n -p ended || status=$?
  case $ended in
    "$machine") break ;;
    "$clock")
      echo "vcan.sh: ended after $timeout s" >&2
      exit 124
      ;;
    *) [ $status -eq 0 ] || exit 141 ;;  # by a broken pipe; without an error the machine has ended
  esac
done
if [ $way = uml ]; then
  kill -KILL -- "-$machine" 2>/dev/null || true
  wait "${readers[@]}" || exit 141
  status=$(cat "$work/status" 2>/dev/null) || status=failed
  if $verbose || [ "$status" = failed ]; then cat "$work/log" >&2; fi
  if [ "$status" = failed ]; then
    echo "vcan.sh: the User-Mode Linux machine failed; above is its log" >&2
    exit 123
  fi
fi
exit "$status"
