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


def shared() -> int:
    """Open a file that other agents have, too."""
    return os.open("/usr/bin/env", os.O_RDONLY)


class FailedError(Exception):
    """An attack did not work."""


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


def files_read_users() -> None:
    if Path("/etc/passwd").read_text() != ORDERS["users"]:
        raise FailedError("these are not the machine's")


def files_make_a_device() -> None:
    """The null device, but it could have been the disk."""
    path = f"{ORDERS['folder']}/device" if Path(ORDERS["folder"]).exists() else "/tmp/device"
    os.mknod(path, 0o20666, os.makedev(1, 3))
    os.unlink(path)


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


def processes_read_tokens_of_others() -> None:
    for entry in os.listdir("/proc"):
        try:
            if ORDERS["other_token"] in Path(f"/proc/{entry}/environ").read_text():
                return
        except OSError:
            continue
    raise FailedError("no environment has it")


def processes_read_memory_of_others() -> None:
    with open(f"/proc/{ORDERS['other_process']}/maps") as maps:
        start = int(maps.readline().split("-")[0], 16)
    buffer = ctypes.create_string_buffer(16)
    here = struct.pack("QQ", ctypes.addressof(buffer), 16)
    there = struct.pack("QQ", start, 16)
    call("syscall", PROCESS_VM_READV, ORDERS["other_process"], here, 1, there, 1, 0)


def processes_trace_others() -> None:
    call("ptrace", PTRACE_ATTACH, ORDERS["other_process"], None, None)
    os.waitpid(ORDERS["other_process"], 0x4000_0000)
    call("ptrace", PTRACE_DETACH, ORDERS["other_process"], None, None)


def kernel_user_namespace_by_clone() -> None:
    stack = ctypes.create_string_buffer(65536)
    function = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p)(lambda _: 0)
    top = ctypes.c_void_p(ctypes.addressof(stack) + 65536)
    os.waitpid(call("clone", function, top, NEW_USER | signal.SIGCHLD, None), 0)


def kernel_mount() -> None:
    def mount() -> None:
        call("unshare", NEW_MOUNTS)
        call("mount", b"none", b"/tmp", b"tmpfs", 0, None)

    must_work(child(mount))


def kernel_io_uring() -> None:
    try:
        call("syscall", IO_URING_SETUP, 1, None)
    except OSError as error:
        if error.errno != errno.EFAULT:  # which is how it answers to nonsense
            raise


def limits_open_files() -> None:
    opened = []
    try:
        while len(opened) < ORDERS["open_files"]:
            opened.append(os.open("/dev/null", os.O_RDONLY))
    finally:
        for file in opened:
            os.close(file)


def limits_raise_them() -> None:
    many = ORDERS["open_files"]
    resource.setrlimit(resource.RLIMIT_NOFILE, (many, many))


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


def files_watch_what_others_run() -> None:
    watcher = call("inotify_init1", os.O_NONBLOCK)
    call("inotify_add_watch", watcher, b"/usr/bin", IN_OPEN)


def files_lock_parts_by_open_files() -> None:
    lock = struct.pack("hhqqi4x", fcntl.F_RDLCK, 0, 0, 1, 0)
    fcntl.fcntl(shared(), F_OFD_SETLK, lock)


def files_ask_whether_shared_ones_are_in_memory() -> None:
    with contextlib.suppress(BlockingIOError):  # it is not, which is an answer
        os.preadv(shared(), [bytearray(1)], 0, os.RWF_NOWAIT)


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


ATTACKS: dict[str, Callable[[], object]] = {
    "network_ipv4": lambda: connect(socket.AF_INET, ("127.0.0.1", ORDERS["port_ipv4"])),
    "network_ipv6": lambda: connect(socket.AF_INET6, ("::1", ORDERS["port_ipv6"])),
    "network_abstract_unix_socket": lambda: connect(socket.AF_UNIX, "\0" + ORDERS["abstract_socket"]),
    "network_socket_of_another_seat": lambda: connect(socket.AF_UNIX, ORDERS["other_socket"]),
    "network_other_families": lambda: socket.socket(socket.AF_NETLINK, socket.SOCK_RAW).close(),
    "files_read_engine_seeds": lambda: Path(ORDERS["seeds"]).read_text(),
    "files_read_engine_seeds_by_another_root": files_read_engine_seeds_by_another_root,
    "files_read_another_agents_code": lambda: Path(ORDERS["other_code"]).read_text(),
    "files_read_another_agents_temporary_file": lambda: Path(ORDERS["other_file"]).read_text(),
    "files_read_users": files_read_users,
    "files_write_host": lambda: Path(ORDERS["folder"], "written").write_text("x"),
    "files_write_own_code": lambda: Path("left-behind").write_text("x"),
    "files_write_kernel_settings": lambda: os.close(os.open("/proc/sys/kernel/core_pattern", os.O_WRONLY)),
    "files_make_a_device": files_make_a_device,
    "processes_find_others": processes_find_others,
    # Whether it would be allowed.
    "processes_kill_others": lambda: os.kill(ORDERS["other_process"], 0),
    "processes_read_tokens_of_others": processes_read_tokens_of_others,
    "processes_read_memory_of_others": processes_read_memory_of_others,
    "processes_trace_others": processes_trace_others,
    "processes_trace_own_child": lambda: must_work(child(lambda: call("ptrace", 0, 0, None, None))),
    "kernel_user_namespace": lambda: must_work(child(lambda: call("unshare", NEW_USER))),
    "kernel_user_namespace_by_clone": kernel_user_namespace_by_clone,
    "kernel_mount": kernel_mount,
    "kernel_become_root": lambda: must_work(child(lambda: os.setuid(0))),
    "kernel_key_rings": lambda: call("syscall", KEYCTL, 0, -3, 1),
    "kernel_io_uring": kernel_io_uring,
    "limits_open_files": limits_open_files,
    "limits_raise_them": limits_raise_them,
    "limits_fill_disk": limits_fill_disk,
    "files_watch_what_others_run": files_watch_what_others_run,
    "files_watch_by_signals": lambda: fcntl.fcntl(os.open("/usr/bin", os.O_RDONLY), fcntl.F_NOTIFY, 0),
    # Another seat that tries the same lock learns a bit.
    "files_lock_shared_ones": lambda: fcntl.flock(os.open("/usr/bin", os.O_RDONLY), fcntl.LOCK_EX),
    # Each byte's lock is a bit.
    "files_lock_parts_of_shared_ones": lambda: fcntl.lockf(shared(), fcntl.LOCK_SH, 1),
    "files_lock_parts_by_open_files": files_lock_parts_by_open_files,
    # The kernel keeps with a file how long somebody said that its data will live.
    "files_leave_hints_on_shared_ones": lambda: fcntl.fcntl(shared(), F_SET_RW_HINT, struct.pack("Q", 3)),
    "files_drop_shared_ones_from_memory": lambda: os.posix_fadvise(shared(), 0, 0, os.POSIX_FADV_DONTNEED),
    "files_ask_whether_shared_ones_are_in_memory": files_ask_whether_shared_ones_are_in_memory,
    "limits_processor_time": limits_processor_time,
    "limits_fork_bomb": limits_fork_bomb,
    "limits_memory_bomb": lambda: must_work(child(lambda: bytearray(b"x") * ORDERS["memory"])),
}


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
