"""The system calls that an agent may make: one policy, as bubblewrap's filter and as a container's profile.

The policy lists what is allowed, since it is impossible to list everything that may be dangerous. It is based
on Docker's default profile (https://docs.docker.com/engine/security/seccomp/), without what an agent does not
need: new namespaces, mounts, tracing and reading of other processes, watching files (which shows what others
do with shared ones), key rings, BPF, io_uring, kernel modules, clocks, and sockets other than unix and
internet ones (AF_VSOCK, for example, reaches out of a virtual machine even if that has no network).
libseccomp, which knows the numbers of calls on every processor, compiles it to bubblewrap's filter.

An agent that runs with this machine's Python shares its files with other agents, read-only. Such an agent
gets no file locks, since others can see a lock on a shared file, so that it could carry messages. An image
has its own files, and its agent may lock them.
"""

import errno
import functools
import tempfile
from typing import Any

from wildscav_evaluator.sandbox.base import SandboxError

# Unknown calls fail as "not implemented", so that C libraries fall back to older calls.
UNKNOWN = errno.ENOSYS
UNIX, INTERNET, INTERNET_6 = 1, 2, 10  # address families
# CLONE_NEWNS, NEWCGROUP, NEWUTS, NEWIPC, NEWUSER, NEWPID, NEWNET
NEW_NAMESPACES = 0x7E02_0000
# Commands of fcntl that get, set and wait for locks: those of processes, and those of open files.
LOCK_COMMANDS = (5, 6, 7, 36, 37, 38)
# Other commands of fcntl: duplicating, flags, owners, signals, pipes and seals. Not allowed are F_SETLEASE,
# F_GETLEASE and F_NOTIFY, which show what others do with a file, and hints on its use, which the kernel
# stores with the file.
FILE_COMMANDS = (*range(5), *range(8, 12), 15, 16, 1027, *range(1030, 1035))
# Advice on how a file will be read, except POSIX_FADV_DONTNEED (4), which evicts it from the page cache that
# all readers share, so that the next reader can notice it.
ADVICE = (0, 1, 2, 3, 5)
ONLY_IF_CACHED = 0x8  # RWF_NOWAIT: read from the page cache or fail, which shows what others have read
PERSONALITIES = (0, 8, 0x20000, 0x20008, 0xFFFF_FFFF)  # the default, 32-bit, and queries

_ALLOWED = """
accept accept4 access alarm arch_prctl bind brk capget capset chdir chmod chown clock_getres clock_gettime
clock_nanosleep close close_range connect copy_file_range creat dup dup2 dup3 epoll_create epoll_create1
epoll_ctl epoll_pwait epoll_pwait2 epoll_wait eventfd eventfd2 execve execveat exit exit_group faccessat
faccessat2 fallocate fchdir fchmod fchmodat fchmodat2 fchown fchownat fdatasync fgetxattr
flistxattr fork fremovexattr fsetxattr fstat fstatfs fsync ftruncate futex futex_requeue futex_wait
futex_waitv futex_wake futimesat get_mempolicy get_robust_list get_thread_area getcpu getcwd getdents
getdents64 getegid geteuid getgid getgroups getitimer getpeername getpgid getpgrp getpid getppid getpriority
getrandom getresgid getresuid getrlimit getrusage getsid getsockname getsockopt gettid gettimeofday getuid
getxattr ioctl ioprio_get ioprio_set kill landlock_add_rule landlock_create_ruleset landlock_restrict_self
lchown lgetxattr link linkat listen listxattr llistxattr lremovexattr lseek lsetxattr lstat madvise mbind
membarrier memfd_create mincore mkdir mkdirat mknod mknodat mlock mlock2 mlockall mmap mprotect mremap mseal
msgctl msgget msgrcv msgsnd msync munlock munlockall munmap nanosleep newfstatat open openat openat2 pause
pidfd_open pidfd_send_signal pipe pipe2 pkey_alloc pkey_free pkey_mprotect poll ppoll prctl pread64 preadv
prlimit64 pselect6 pwrite64 pwritev pwritev2 read readahead readlink readlinkat readv recvfrom
recvmmsg recvmsg remap_file_pages removexattr rename renameat renameat2 restart_syscall rmdir rseq
rt_sigaction rt_sigpending rt_sigprocmask rt_sigqueueinfo rt_sigreturn rt_sigsuspend rt_sigtimedwait
rt_tgsigqueueinfo sched_get_priority_max sched_get_priority_min sched_getaffinity sched_getattr
sched_getparam sched_getscheduler sched_rr_get_interval sched_setaffinity sched_setattr sched_setparam
sched_setscheduler sched_yield seccomp select semctl semget semop semtimedop sendfile sendmmsg sendmsg
sendto set_mempolicy set_robust_list set_thread_area set_tid_address setfsgid setfsuid setgid setgroups
setitimer setpgid setpriority setregid setresgid setresuid setreuid setrlimit setsid setsockopt setuid
setxattr shmat shmctl shmdt shmget shutdown sigaltstack signalfd signalfd4 splice stat statfs statx symlink
symlinkat sync sync_file_range syncfs sysinfo tee tgkill time timer_create timer_delete timer_getoverrun
timer_gettime timer_settime timerfd_create timerfd_gettime timerfd_settime times tkill truncate umask uname
unlink unlinkat utime utimensat utimes vfork wait4 waitid write writev
"""
ALLOWED = frozenset(_ALLOWED.split())
# Calls that fail with "operation not permitted", so that an author understands why.
_REFUSED = """
acct add_key bpf chroot clock_settime delete_module fanotify_init fanotify_mark finit_module fsmount fsopen
init_module inotify_add_watch inotify_init inotify_init1 inotify_rm_watch io_uring_enter io_uring_register
io_uring_setup ioperm iopl kcmp kexec_load keyctl mount mount_setattr move_mount name_to_handle_at
open_by_handle_at open_tree perf_event_open pidfd_getfd pivot_root process_madvise process_vm_readv
process_vm_writev ptrace quotactl reboot request_key setdomainname sethostname setns settimeofday swapoff
swapon syslog umount2 unshare userfaultfd vhangup
"""
REFUSED = frozenset(_REFUSED.split())


def container_profile(*, locks: bool) -> dict[str, Any]:
    """Return the policy in the format of Docker and Podman.

    An agent may lock files (``locks``) if it shares none.
    """
    allow, refuse = "SCMP_ACT_ALLOW", "SCMP_ACT_ERRNO"
    rules: list[dict[str, Any]] = [
        {"names": sorted(ALLOWED), "action": allow},
        {"names": sorted(REFUSED), "action": refuse, "errnoRet": errno.EPERM},
        # Docker 20 ignores defaultErrnoRet, and threads start by clone only if clone3 is not implemented.
        {"names": ["clone3"], "action": refuse, "errnoRet": UNKNOWN},
        {"names": ["clone"], "action": allow, "args": [_masked(0, NEW_NAMESPACES, 0)]},
        {"names": ["preadv2"], "action": allow, "args": [_masked(5, ONLY_IF_CACHED, 0)]},
    ]
    lock = {"action": allow} if locks else {"action": refuse, "errnoRet": errno.ENOLCK}
    rules.append({"names": ["flock"], **lock})
    rules += [{"names": ["fcntl"], **lock, "args": [_equal(1, command)]} for command in LOCK_COMMANDS]
    rules += [
        {"names": [name], "action": allow, "args": [_equal(index, value)]}
        for name, (index, values) in EXACTLY.items()
        for value in values
    ]
    return {"defaultAction": refuse, "defaultErrnoRet": UNKNOWN, "syscalls": rules}


# Calls with an argument, counted from 0, that must have one of these values.
EXACTLY = {
    "fadvise64": (3, ADVICE),
    "fcntl": (1, FILE_COMMANDS),
    "personality": (0, PERSONALITIES),
    "socket": (0, (UNIX, INTERNET, INTERNET_6)),
    "socketpair": (0, (UNIX,)),
}


def _equal(index: int, value: int) -> dict[str, Any]:
    return {"index": index, "value": value, "op": "SCMP_CMP_EQ"}


def _masked(index: int, mask: int, value: int) -> dict[str, Any]:
    return {"index": index, "value": mask, "valueTwo": value, "op": "SCMP_CMP_MASKED_EQ"}


@functools.cache
def bpf_filter() -> bytes:
    """Return the policy as a BPF program, without file locks; SandboxError without libseccomp."""
    try:
        import pyseccomp as library
    except (ImportError, RuntimeError, OSError) as error:
        raise SandboxError(f"no filter of system calls can be made: {error}; install libseccomp2") from None
    policy = library.SyscallFilter(library.ERRNO(UNKNOWN))
    processor = library.system_arch()
    for name in sorted(ALLOWED | REFUSED):
        # Older libraries lack newer calls; without a rule these fail as not implemented.
        if int(library.resolve_syscall(processor, name)) >= 0:
            policy.add_rule(library.ALLOW if name in ALLOWED else library.ERRNO(errno.EPERM), name)
    policy.add_rule(library.ALLOW, "clone", library.Arg(0, library.MASKED_EQ, NEW_NAMESPACES, 0))
    policy.add_rule(library.ALLOW, "preadv2", library.Arg(5, library.MASKED_EQ, ONLY_IF_CACHED, 0))
    policy.add_rule(library.ERRNO(errno.ENOLCK), "flock")
    for command in LOCK_COMMANDS:
        policy.add_rule(library.ERRNO(errno.ENOLCK), "fcntl", library.Arg(1, library.EQ, command))
    for name, (index, values) in EXACTLY.items():
        for value in values:
            policy.add_rule(library.ALLOW, name, library.Arg(index, library.EQ, value))
    with tempfile.TemporaryFile() as file:
        policy.export_bpf(file)
        file.seek(0)
        return file.read()
