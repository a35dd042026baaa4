"""An agent that tries to break out, once, and prints what came of each attack.

Every attack is bounded in size and time and does no harm where it works: it runs without a sandbox, too.
It returns if it worked, and raises if it did not.
"""

import contextlib
import ctypes
import errno
import fcntl
import json
import os
import resource
import signal
import socket
import struct
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

ORDERS = json.loads(Path("orders.json").read_text())  # what is where on the machine
LIBC = ctypes.CDLL(None, use_errno=True)
MEBIBYTE = 1 << 20
NEW_USER, NEW_MOUNTS = 0x1000_0000, 0x0002_0000
PTRACE_ATTACH, PTRACE_DETACH = 16, 17
IN_OPEN = 0x20
F_OFD_SETLK, F_SET_RW_HINT = 37, 1036
KEYCTL, IO_URING_SETUP, PROCESS_VM_READV = 250, 425, 310  # x86-64
ATTACKS: dict[str, Callable[[], object]] = {}


class FailedError(Exception):
    """An attack did not work."""


def attack(function: Callable[[], object]) -> Callable[[], object]:
    ATTACKS[function.__name__] = function
    return function


def call(function: str, *arguments: object) -> int:
    # Whole registers: an int would leave half of a system call's argument to chance.
    whole = [ctypes.c_long(one) if isinstance(one, int) else one for one in arguments]
    result = int(getattr(LIBC, function)(*whole))
    if result == -1:
        raise OSError(ctypes.get_errno(), f"{function}: {os.strerror(ctypes.get_errno())}")
    return result


def child(work: Callable[[], object]) -> int:
    """Run something in a child process; return its wait status."""
    process = os.fork()
    if process == 0:
        try:
            work()
            os._exit(0)
        except OSError as error:
            os._exit(error.errno or 1)
        except BaseException:
            os._exit(1)
    return os.waitpid(process, 0)[1]


def must_work(status: int) -> None:
    if status != 0:
        raise FailedError(f"child ended with status {status}")


def connect(family: int, address: object) -> None:
    with socket.socket(family) as plug:
        plug.settimeout(2)
        plug.connect(address)


@attack
def network_ipv4() -> None:
    connect(socket.AF_INET, ("127.0.0.1", ORDERS["port_ipv4"]))


@attack
def network_ipv6() -> None:
    connect(socket.AF_INET6, ("::1", ORDERS["port_ipv6"]))


@attack
def network_abstract_unix_socket() -> None:
    connect(socket.AF_UNIX, "\0" + ORDERS["abstract_socket"])


@attack
def network_socket_of_another_seat() -> None:
    connect(socket.AF_UNIX, ORDERS["other_socket"])


@attack
def network_other_families() -> None:
    socket.socket(socket.AF_NETLINK, socket.SOCK_RAW).close()


@attack
def files_read_engine_seeds() -> None:
    Path(ORDERS["seeds"]).read_text()


@attack
def files_read_engine_seeds_by_another_root() -> None:
    """The roots of other processes are doors to their files."""
    doors = [f"/proc/{entry}/root" for entry in os.listdir("/proc") if entry.isdecimal()]
    doors += [f"/proc/self/cwd/{'../' * 12}", f"/proc/self/fd/1/{'../' * 12}"]
    for door in doors:
        try:
            return print(len(Path(door + ORDERS["seeds"]).read_text()))
        except OSError:
            continue
    raise FailedError("no door leads there")


@attack
def files_read_another_agents_code() -> None:
    Path(ORDERS["other_code"]).read_text()


@attack
def files_read_another_agents_temporary_file() -> None:
    Path(ORDERS["other_file"]).read_text()


@attack
def files_read_users() -> None:
    if Path("/etc/passwd").read_text() != ORDERS["users"]:
        raise FailedError("these are not the machine's")


@attack
def files_write_host() -> None:
    Path(ORDERS["folder"], "written").write_text("x")


@attack
def files_write_own_code() -> None:
    Path("left-behind").write_text("x")


@attack
def files_write_kernel_settings() -> None:
    os.close(os.open("/proc/sys/kernel/core_pattern", os.O_WRONLY))


@attack
def files_make_a_device() -> None:
    """The null device, but it could have been the disk."""
    path = f"{ORDERS['folder']}/device" if Path(ORDERS["folder"]).exists() else "/tmp/device"
    os.mknod(path, 0o20666, os.makedev(1, 3))
    os.unlink(path)


@attack
def processes_find_others() -> None:
    for entry in os.listdir("/proc"):
        if entry.isdecimal() and ORDERS["marker"] in command_line(entry):
            return
    raise FailedError("no such process is seen")


def command_line(process: str) -> str:
    try:
        return Path(f"/proc/{process}/cmdline").read_text()
    except OSError:
        return ""


@attack
def processes_kill_others() -> None:
    os.kill(ORDERS["other_process"], 0)  # whether it would be allowed


@attack
def processes_read_tokens_of_others() -> None:
    for entry in os.listdir("/proc"):
        try:
            if ORDERS["other_token"] in Path(f"/proc/{entry}/environ").read_text():
                return
        except OSError:
            continue
    raise FailedError("no environment has it")


@attack
def processes_read_memory_of_others() -> None:
    with open(f"/proc/{ORDERS['other_process']}/maps") as maps:
        start = int(maps.readline().split("-")[0], 16)
    buffer = ctypes.create_string_buffer(16)
    here = struct.pack("QQ", ctypes.addressof(buffer), 16)
    there = struct.pack("QQ", start, 16)
    call("syscall", PROCESS_VM_READV, ORDERS["other_process"], here, 1, there, 1, 0)


@attack
def processes_trace_others() -> None:
    call("ptrace", PTRACE_ATTACH, ORDERS["other_process"], None, None)
    os.waitpid(ORDERS["other_process"], 0x4000_0000)
    call("ptrace", PTRACE_DETACH, ORDERS["other_process"], None, None)


@attack
def processes_trace_own_child() -> None:
    must_work(child(lambda: call("ptrace", 0, 0, None, None)))


@attack
def kernel_user_namespace() -> None:
    must_work(child(lambda: call("unshare", NEW_USER)))


@attack
def kernel_user_namespace_by_clone() -> None:
    stack = ctypes.create_string_buffer(65536)
    function = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p)(lambda _: 0)
    top = ctypes.c_void_p(ctypes.addressof(stack) + 65536)
    os.waitpid(call("clone", function, top, NEW_USER | signal.SIGCHLD, None), 0)


@attack
def kernel_mount() -> None:
    def mount() -> None:
        call("unshare", NEW_MOUNTS)
        call("mount", b"none", b"/tmp", b"tmpfs", 0, None)

    must_work(child(mount))


@attack
def kernel_become_root() -> None:
    must_work(child(lambda: os.setuid(0)))


@attack
def kernel_key_rings() -> None:
    call("syscall", KEYCTL, 0, -3, 1)


@attack
def kernel_io_uring() -> None:
    try:
        call("syscall", IO_URING_SETUP, 1, None)
    except OSError as error:
        if error.errno != errno.EFAULT:  # which is how it answers to nonsense
            raise


@attack
def limits_open_files() -> None:
    opened = []
    try:
        while len(opened) < ORDERS["open_files"]:
            opened.append(os.open("/dev/null", os.O_RDONLY))
    finally:
        for file in opened:
            os.close(file)


@attack
def limits_raise_them() -> None:
    many = ORDERS["open_files"]
    resource.setrlimit(resource.RLIMIT_NOFILE, (many, many))


@attack
def limits_fill_disk() -> None:
    """In any one place that can be written to."""
    places = ["/tmp", "/dev/shm", "/var/tmp", "/run", "/dev", "/", ORDERS["folder"], os.getcwd(), "/proc"]
    for place in places:
        path = Path(place, f"filling-{os.getpid()}")
        try:
            with path.open("wb") as file:
                for _ in range(ORDERS["disk"] // MEBIBYTE):
                    file.write(bytes(MEBIBYTE))
            return
        except OSError:
            continue
        finally:
            if path.parent.exists() and path.exists():
                path.unlink()
    raise FailedError("no place takes so much")


@attack
def files_watch_what_others_run() -> None:
    watcher = call("inotify_init1", os.O_NONBLOCK)
    call("inotify_add_watch", watcher, b"/usr/bin", IN_OPEN)


@attack
def files_watch_by_signals() -> None:
    fcntl.fcntl(os.open("/usr/bin", os.O_RDONLY), fcntl.F_NOTIFY, 0)


@attack
def files_lock_shared_ones() -> None:
    """Another seat that tries the same lock learns a bit."""
    fcntl.flock(os.open("/usr/bin", os.O_RDONLY), fcntl.LOCK_EX)


@attack
def files_lock_parts_of_shared_ones() -> None:
    """Each byte's lock is a bit."""
    fcntl.lockf(os.open("/usr/bin/env", os.O_RDONLY), fcntl.LOCK_SH, 1)


@attack
def files_lock_parts_by_open_files() -> None:
    lock = struct.pack("hhqqi4x", fcntl.F_RDLCK, 0, 0, 1, 0)
    fcntl.fcntl(os.open("/usr/bin/env", os.O_RDONLY), F_OFD_SETLK, lock)


@attack
def files_leave_hints_on_shared_ones() -> None:
    """The kernel keeps with a file how long somebody said that its data will live."""
    fcntl.fcntl(os.open("/usr/bin/env", os.O_RDONLY), F_SET_RW_HINT, struct.pack("Q", 3))


@attack
def files_drop_shared_ones_from_memory() -> None:
    os.posix_fadvise(os.open("/usr/bin/env", os.O_RDONLY), 0, 0, os.POSIX_FADV_DONTNEED)


@attack
def files_ask_whether_shared_ones_are_in_memory() -> None:
    with contextlib.suppress(BlockingIOError):  # it is not, which is an answer
        os.preadv(os.open("/usr/bin/env", os.O_RDONLY), [bytearray(1)], 0, os.RWF_NOWAIT)


@attack
def limits_processor_time() -> None:
    hogs, started = 8, time.monotonic()
    before = os.times()
    for hog in [os.fork() or burn(started + 1.0) for _ in range(hogs)]:
        os.waitpid(hog, 0)
    after = os.times()
    used = after.children_user + after.children_system - before.children_user - before.children_system
    if used / (time.monotonic() - started) < ORDERS["cpus"]:
        raise FailedError(f"{used:.2f} s of processor time in {time.monotonic() - started:.2f} s")


def burn(until: float) -> int:
    os.setsid()  # on a busy machine Linux shares time out by sessions
    while time.monotonic() < until:
        pass
    os._exit(0)


@attack
def limits_fork_bomb() -> None:
    children: list[int] = []
    try:
        while len(children) < ORDERS["processes"]:
            process = os.fork()
            if process == 0:
                time.sleep(30)
                os._exit(0)
            children.append(process)
    finally:
        for process in children:
            os.kill(process, signal.SIGKILL)
            os.waitpid(process, 0)


@attack
def limits_memory_bomb() -> None:
    must_work(child(lambda: bytearray(b"x") * ORDERS["memory"]))


def main() -> None:
    for name, function in ATTACKS.items():
        try:
            function()
            print("ATTACK", name, "worked", flush=True)
        except (OSError, ValueError, MemoryError, FailedError) as error:
            print("ATTACK", name, "failed:", str(error).replace("\n", " "), flush=True)
    # A daemon that wants to outlive the match.
    survivor = [sys.executable, "-c", "import time; time.sleep(60)", ORDERS["survivor"]]
    if child(lambda: (os.setsid(), subprocess.Popen(survivor))) == 0:
        print("DAEMON", flush=True)
    print("FLOOD", flush=True)
    for _ in range(ORDERS["flood"] // 65536):
        os.write(1, b"x" * 65535 + b"\n")
    os._exit(7)


main()
