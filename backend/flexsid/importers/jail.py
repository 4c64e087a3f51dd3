"""Jail: a process that reads untrusted content opens its input, and nothing else.

Content may be made to run code in the library that reads it. On Linux this code cannot open other
files (Landlock; without it, namespaces in which no others exist), connect, start programs, or reach
other processes (a seccomp filter of system calls). It still reads the installed programs, which
libraries load on use. The program ``bwrap`` uses the same namespaces, so that it adds nothing.

The system calls are bound here. Of the packages for them, those for Landlock are first
versions and those for seccomp bind a library of the system that is not always installed (pyseccomp,
last released in 2021), or bring a container runtime of 13 MB.
"""

from __future__ import annotations

import ctypes
import errno
import os
import platform
import re
import signal
import struct
import subprocess
import sys
import sysconfig
from collections.abc import Iterator, Sequence
from functools import cache
from pathlib import Path
from typing import NoReturn

_IS_LINUX = sys.platform == "linux"

# <linux/prctl.h>
_SET_DEATH_SIGNAL, _SET_SECCOMP, _SET_NO_NEW_PRIVILEGES = 1, 22, 38

# <linux/landlock.h>; these numbers are those of all architectures.
_CREATE_RULESET, _ADD_RULE, _RESTRICT_SELF = 444, 445, 446
_ASK_VERSION, _PATH_BENEATH = 1, 1
_EXECUTE, _WRITE_FILE, _READ_FILE, _READ_FOLDER = 1, 1 << 1, 1 << 2, 1 << 3
_REMOVE_FOLDER, _REMOVE_FILE, _MAKE_FOLDER, _MAKE_FILE = 1 << 4, 1 << 5, 1 << 7, 1 << 8
_TRUNCATE = 1 << 14
_READ = _READ_FILE | _READ_FOLDER
_CHANGE = _WRITE_FILE | _TRUNCATE | _REMOVE_FOLDER | _REMOVE_FILE | _MAKE_FOLDER | _MAKE_FILE
_OF_FILES = _READ_FILE | _WRITE_FILE | _TRUNCATE | _EXECUTE
_LEAST_VERSION = 3  # before, files could be truncated

# Rights on files, rights on TCP ports, and scopes (sockets, signals) that each version knows.
_KNOWN_RIGHTS = ((1, 13, 0, 0), (2, 14, 0, 0), (3, 15, 0, 0), (4, 15, 2, 0), (5, 16, 2, 0))
_KNOWN_RIGHTS += ((6, 16, 2, 2),)

# <linux/sched.h>, <linux/mount.h> and <linux/capability.h>
_NEW_NAMESPACES = 0x10000000 | 0x00020000 | 0x40000000 | 0x08000000  # user, mount, network, IPC
_READ_ONLY, _NO_SUID, _NO_DEVICES, _NO_EXEC = 1, 2, 4, 8
_REMOUNT, _BIND, _RECURSIVE, _PRIVATE, _DETACH = 1 << 5, 1 << 12, 1 << 14, 1 << 18, 2
_KEPT_OPTIONS = {
    **{os.ST_NOSUID: _NO_SUID, os.ST_NODEV: _NO_DEVICES, os.ST_NOEXEC: _NO_EXEC},
    **{os.ST_NOATIME: 1 << 10, os.ST_NODIRATIME: 1 << 11, os.ST_RELATIME: 1 << 21},
}
"""Options of a mount, as the file system reports them and as they are set: none may be left out."""
_CAPABILITIES = 0x20080522
_SECONDS_TO_TRY = 30.0

# <linux/filter.h> and <linux/seccomp.h>
_LOAD, _IF_EQUAL, _IF_AT_LEAST, _IF_ANY_BIT, _RETURN = 0x20, 0x15, 0x35, 0x45, 0x06
_NUMBER, _ARCHITECTURE, _FIRST_ARGUMENT = 0, 4, 16  # offsets
_KILL, _ALLOW, _FAIL = 0x80000000, 0x7FFF0000, 0x00050000
_FILTER = 2
_OTHER_NUMBERS = 0x40000000  # of the x32 interface of x86-64
_THREAD = 0x00010000  # CLONE_THREAD

_ARCHITECTURES = {"x86_64": 0xC000003E, "aarch64": 0xC00000B7}
_CLONE, _SIGNAL_THREAD, _LIMIT = (56, 220), (234, 131), (302, 261)
_CLONE3 = 435
_REFUSED: tuple[tuple[int | None, int | None], ...] = (
    # socket, socketpair, connect, accept, accept4, bind, listen, sendto, sendmsg, sendmmsg
    *((41, 198), (53, 199), (42, 203), (43, 202), (288, 242), (49, 200), (50, 201)),
    *((44, 206), (46, 211), (307, 269)),
    # execve, execveat, fork, vfork
    *((59, 221), (322, 281), (57, None), (58, None)),
    # kill, tkill, rt_sigqueueinfo, rt_tgsigqueueinfo, ptrace, process_vm_readv, process_vm_writev
    *((62, 129), (200, 130), (129, 138), (297, 240), (101, 117), (310, 270), (311, 271)),
    # kcmp, pidfd_send_signal, pidfd_open, pidfd_getfd, process_madvise
    *((312, 272), (424, 424), (434, 434), (438, 438), (440, 440)),
    # io_uring_setup, io_uring_enter, io_uring_register: they do what this filter refuses
    *((425, 425), (426, 426), (427, 427)),
    # chmod, fchmod, fchmodat, fchmodat2, chown, fchown, lchown, fchownat: not of Landlock
    *((90, None), (91, 52), (268, 53), (452, 452), (92, None), (93, 55), (94, None), (260, 54)),
    # setxattr, lsetxattr, fsetxattr, removexattr, lremovexattr, fremovexattr, setxattrat,
    # removexattrat, file_setattr
    *((188, 5), (189, 6), (190, 7), (197, 14), (198, 15), (199, 16), (463, 463), (466, 466)),
    *((469, 469),),
    # utime, utimes, futimesat, utimensat, truncate
    *((132, None), (235, None), (261, None), (280, 88), (76, 45)),
    # shmget, semget, msgget, mq_open, add_key, request_key, keyctl
    *((29, 194), (64, 190), (68, 186), (240, 180), (248, 217), (249, 218), (250, 219)),
    # mount, umount2, pivot_root, chroot, unshare, setns, open_tree, move_mount, fsopen, fsconfig,
    # fsmount, fspick, mount_setattr, name_to_handle_at, open_by_handle_at
    *((165, 40), (166, 39), (155, 41), (161, 51), (272, 97), (308, 268), (428, 428), (429, 429)),
    *((430, 430), (431, 431), (432, 432), (433, 433), (442, 442), (303, 264), (304, 265)),
    # bpf, perf_event_open, userfaultfd, fanotify_init, syslog, acct, quotactl
    *((321, 280), (298, 241), (323, 282), (300, 262), (103, 116), (163, 89), (179, 60)),
    # init_module, finit_module, delete_module, kexec_load, kexec_file_load, reboot, swapon, swapoff
    *((175, 105), (313, 273), (176, 106), (246, 104), (320, 294), (169, 142), (167, 224)),
    *((168, 225),),
    # settimeofday, clock_settime, adjtimex, clock_adjtime, sethostname, setdomainname, iopl, ioperm
    *((164, 170), (227, 112), (159, 171), (305, 266), (170, 161), (171, 162), (172, None)),
    *((173, None),),
)
"""Numbers of refused system calls, of x86-64 and of 64-bit ARM."""


def enter(inputs: Sequence[Path], folder: Path) -> None:
    """Confine this process until its end, as far as the platform can.

    It must have one thread. Files that are open remain so.

    Parameters
    ----------
    inputs
        Files that it may read.
    folder
        Folder in which it may write and delete.

    Raises
    ------
    OSError
        If a measure that the platform has fails.
    """
    if not _IS_LINUX:
        return
    _control(_SET_DEATH_SIGNAL, signal.SIGKILL)
    _control(_SET_NO_NEW_PRIVILEGES, 1)
    if find_landlock_version() < _LEAST_VERSION and has_namespaces():
        _enter_namespaces(inputs, folder)
    if find_landlock_version():
        _restrict_files(inputs, folder)
    if _has_filter():
        _restrict_calls()


def list_missing() -> tuple[str, ...]:
    """List what the platform does not keep a process in the jail from, with the reason."""
    missing = []
    if find_landlock_version() < _LEAST_VERSION and not has_namespaces():
        missing.append(
            "open other files of the user of the server: Landlock is missing (Linux 6.2 or newer, "
            "with landlock in its list of security modules), and so are namespaces of users"
        )
    if not _has_filter():
        missing.append(
            "open connections and start programs: seccomp filters are missing (Linux on x86-64 or "
            "64-bit ARM)"
        )
    return tuple(missing)


@cache
def find_landlock_version() -> int:
    """Return the version of Landlock of this kernel, 0 without Landlock."""
    if not _IS_LINUX:
        return 0
    return max(0, _library().syscall(_CREATE_RULESET, None, ctypes.c_size_t(0), _ASK_VERSION))


@cache
def has_namespaces() -> bool:
    """Return whether a process may enter namespaces of its own, which another one tries."""
    if not _IS_LINUX:
        return False
    attempt = (
        "import sys, tempfile; from pathlib import Path\n"
        f"sys.path.insert(0, {str(Path(__file__).parents[2])!r})\n"
        "from flexsid.importers import jail\n"
        "with tempfile.TemporaryDirectory() as folder:\n"
        "    process = jail.os.fork()\n"
        "    if process == 0:\n"
        "        jail.try_namespaces(Path(folder))\n"
        "    sys.exit(jail.os.waitstatus_to_exitcode(jail.os.waitpid(process, 0)[1]))\n"
    )
    try:
        done = subprocess.run(
            [sys.executable, "-P", "-c", attempt],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            timeout=_SECONDS_TO_TRY,
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired):
        return False
    return done.returncode == 0


def try_namespaces(folder: Path) -> NoReturn:
    """Enter namespaces and end this process, with exit code 0 if it has entered them."""
    code = 1
    try:
        _enter_namespaces([], folder)
        code = 0
    finally:
        os._exit(code)


@cache
def _has_filter() -> bool:
    if not _IS_LINUX or platform.machine() not in _ARCHITECTURES or sys.maxsize < 2**32:
        return False
    # Without a program the kernel reports a bad address; it does nothing else.
    done = _library().prctl(_SET_SECCOMP, _FILTER, None, 0, 0)
    return done == -1 and ctypes.get_errno() == errno.EFAULT


@cache
def _library() -> ctypes.CDLL:
    return ctypes.CDLL(None, use_errno=True)


def _control(option: int, value: int) -> None:
    _check(_library().prctl(option, *(ctypes.c_ulong(one) for one in (value, 0, 0, 0))))


def _check(result: int) -> int:
    if result < 0:
        number = ctypes.get_errno()
        raise OSError(number, os.strerror(number))
    return result


def _enter_namespaces(inputs: Sequence[Path], folder: Path) -> None:
    """Enter namespaces that have the inputs, the folder and the programs, and no network."""
    user, group = os.getuid(), os.getgid()
    _check(_library().unshare(_NEW_NAMESPACES))
    Path("/proc/self/setgroups").write_text("deny")
    Path("/proc/self/uid_map").write_text(f"{user} {user} 1")
    Path("/proc/self/gid_map").write_text(f"{group} {group} 1")
    _mount(None, Path("/"), _RECURSIVE | _PRIVATE)

    # The new root hides what its place holds, so that all that it shows is opened before.
    shown = sorted(
        {*_list_programs(), Path(os.devnull), *inputs, folder}, key=lambda p: len(str(p))
    )
    opened = [
        (path, path.is_dir(), os.open(path, os.O_PATH | os.O_CLOEXEC))
        for path in shown
        if path.exists()
    ]
    root = folder.parent
    _mount("tmpfs", root, _NO_SUID | _NO_DEVICES, kind="tmpfs")
    for path, is_folder, number in opened:
        target = root / path.relative_to("/")
        if path == folder or not target.exists():  # otherwise it is in a folder that is shown
            (target if is_folder else target.parent).mkdir(parents=True, exist_ok=True)
            if not is_folder:
                target.touch()
            _mount(f"/proc/self/fd/{number}", target, _BIND | _RECURSIVE)
        os.close(number)
    writable = {root / path.relative_to("/") for path in (folder, Path(os.devnull))}
    for target in (*_list_mounts(root), root):
        if target not in writable:
            stated = os.statvfs(target).f_flag
            kept = sum(option for state, option in _KEPT_OPTIONS.items() if stated & state)
            _mount(None, target, _REMOUNT | _BIND | _READ_ONLY | kept)

    os.chdir(root)
    _check(_library().pivot_root(b".", b"."))
    _check(_library().umount2(b".", _DETACH))  # the old root, which lies above the new one
    os.chdir(folder)
    head, nothing = struct.pack("=Ii", _CAPABILITIES, 0), bytes(24)
    _check(_library().capset(head, nothing))


def _list_mounts(root: Path) -> list[Path]:
    """List what is mounted below a folder; names have blanks and such as octal numbers."""
    rows = Path("/proc/self/mountinfo").read_bytes().splitlines()
    paths = (
        re.sub(rb"\\(\d{3})", lambda code: bytes([int(code[1], 8)]), row.split(b" ")[4])
        for row in rows
    )
    return [path for path in map(Path, map(os.fsdecode, paths)) if root in path.parents]


def _mount(source: str | None, target: Path, options: int, kind: str | None = None) -> None:
    texts = (None if text is None else os.fsencode(text) for text in (source, target, kind))
    _check(_library().mount(*texts, ctypes.c_ulong(options), None))


def _restrict_files(inputs: Sequence[Path], folder: Path) -> None:
    _, *known = [one for one in _KNOWN_RIGHTS if one[0] <= find_landlock_version()][-1]
    files, ports, scopes = ((1 << number) - 1 for number in known)
    # A kernel takes the part of this structure that it knows, if the rest is zero.
    handled = struct.pack("=QQQ", files, ports, scopes)
    ruleset = _check(_library().syscall(_CREATE_RULESET, handled, ctypes.c_size_t(len(handled)), 0))
    try:
        for path in (*_list_programs(), *inputs):
            _allow(ruleset, path, _READ & files)
        _allow(ruleset, Path(os.devnull), (_READ_FILE | _WRITE_FILE) & files)
        _allow(ruleset, folder, (_READ | _CHANGE) & files)
        _check(_library().syscall(_RESTRICT_SELF, ruleset, 0))
    finally:
        os.close(ruleset)


def _list_programs() -> Iterator[Path]:
    """List folders and files of Python, its packages and libraries, which are no secret."""
    yield from (Path(entry) for entry in sys.path if entry)
    configured = (sysconfig.get_config_var(name) for name in ("LIBDIR", "DESTSHARED"))
    yield from (Path(folder) for folder in configured if folder)
    yield from map(Path, ("/lib", "/lib64", "/usr/lib", "/usr/lib64", "/usr/local/lib"))
    yield from map(Path, ("/etc/ld.so.cache", "/etc/localtime", "/usr/share/zoneinfo"))
    yield from map(Path, ("/dev/urandom", "/dev/zero"))


def _allow(ruleset: int, path: Path, rights: int) -> None:
    """Allow rights on a file, or beneath a folder; what does not exist needs none."""
    try:
        opened = os.open(path, os.O_PATH | os.O_CLOEXEC)
    except OSError:
        return
    try:
        allowed = rights if path.is_dir() else rights & _OF_FILES
        rule = struct.pack("=Qi", allowed, opened)
        _check(_library().syscall(_ADD_RULE, ruleset, _PATH_BENEATH, rule, 0))
    finally:
        os.close(opened)


def _restrict_calls() -> None:
    """Refuse system calls; memory is changed by those of this architecture only."""
    machine = platform.machine()
    index = list(_ARCHITECTURES).index(machine)
    refuse = (_RETURN, 0, 0, _FAIL | errno.EPERM)
    allow = (_RETURN, 0, 0, _ALLOW)
    program = [
        (_LOAD, 0, 0, _ARCHITECTURE),
        (_IF_EQUAL, 1, 0, _ARCHITECTURES[machine]),
        (_RETURN, 0, 0, _KILL),
        (_LOAD, 0, 0, _NUMBER),
        (_IF_AT_LEAST, 0, 1, _OTHER_NUMBERS),
        (_RETURN, 0, 0, _KILL),
        (_IF_EQUAL, 0, 1, _CLONE3),  # its arguments are in memory; libraries then use clone
        (_RETURN, 0, 0, _FAIL | errno.ENOSYS),
    ]
    for numbers in _REFUSED:
        number = numbers[index]
        if number is not None:
            program += [(_IF_EQUAL, 0, 1, number), refuse]
    for numbers, condition, value in (
        (_CLONE, _IF_ANY_BIT, _THREAD),
        (_SIGNAL_THREAD, _IF_EQUAL, os.getpid()),
        (_LIMIT, _IF_EQUAL, 0),  # of this process
    ):
        program += [(_IF_EQUAL, 0, 4, numbers[index]), (_LOAD, 0, 0, _FIRST_ARGUMENT)]
        program += [(condition, 0, 1, value), allow, refuse]
    program.append(allow)
    code = ctypes.create_string_buffer(b"".join(struct.pack("=HBBI", *one) for one in program))
    head = struct.pack("@HP", len(program), ctypes.addressof(code))
    _check(_library().prctl(_SET_SECCOMP, _FILTER, head, 0, 0))
