"""Run a command that the kernel kills as soon as it opens a socket (Linux on x86-64 or 64-bit ARM).

The kernel itself looks at every system call of the process and of its children (seccomp), so native code is watched as
well as Python. Sockets of every kind count, also local ones: the resolvers of some systems look up a host through one.
"""

import ctypes
import os
import platform
import signal
import struct
import sys

from tests.helpers.processes import ran

#: The number of the system call `socket` on each machine.
SOCKET_CALLS = {"x86_64": 41, "aarch64": 198}

#: Whether this machine can run `run_without_sockets`.
IS_AVAILABLE = sys.platform == "linux" and sys.maxsize > 2**32 and platform.machine() in SOCKET_CALLS

#: The return code of a process that opened a socket: negative, because a signal killed it.
OPENED_A_SOCKET = -signal.SIGSYS if IS_AVAILABLE else None

# From the kernel's headers linux/prctl.h, linux/seccomp.h and linux/bpf_common.h.
PR_SET_SECCOMP, PR_SET_NO_NEW_PRIVS, SECCOMP_MODE_FILTER = 22, 38, 2
SECCOMP_RET_KILL_PROCESS, SECCOMP_RET_ALLOW = 0x80000000, 0x7FFF0000
LOAD_WORD, JUMP_IF_EQUAL, RETURN = 0x20, 0x15, 0x06


def run_without_sockets(command, **options):
    """Run `command`; its return code is `OPENED_A_SOCKET` if it tried to open a socket, which ended it."""
    return ran(*command, preexec_fn=_forbid_sockets, **options)


class _Program(ctypes.Structure):
    """The kernel's `struct sock_fprog`: a filter of system calls."""

    _fields_ = [("length", ctypes.c_ushort), ("instructions", ctypes.c_char_p)]


def _forbid_sockets():
    """Have the kernel kill this process, and whatever it starts, at its first `socket`."""
    instructions = [
        (LOAD_WORD, 0, 0, 0),  # the number of the system call
        (JUMP_IF_EQUAL, 0, 1, SOCKET_CALLS[platform.machine()]),  # if it is another, skip one instruction
        (RETURN, 0, 0, SECCOMP_RET_KILL_PROCESS),
        (RETURN, 0, 0, SECCOMP_RET_ALLOW),
    ]
    program = _Program(len(instructions), b"".join(struct.pack("HBBI", *instruction) for instruction in instructions))
    _prctl(PR_SET_NO_NEW_PRIVS, 1)
    _prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, ctypes.addressof(program))


def _prctl(option, *arguments):
    """Change an attribute of this process."""
    padded = [ctypes.c_ulong(argument) for argument in (*arguments, 0, 0, 0, 0)][:4]
    if ctypes.CDLL(None, use_errno=True).prctl(option, *padded) != 0:
        raise OSError(ctypes.get_errno(), f"prctl({option}) was refused: {os.strerror(ctypes.get_errno())}")
