# SPDX-License-Identifier: BSD-2-Clause
"""A sweep in the ranks of a communicator of mpi4py: each rank runs the command `dyn`, and Python carries the messages between them.

A message on the socket of `dyn` is a line with the other rank's number and the bytes of the text, then the text. Between the ranks of the
communicator it is a pair of rank and text; a pair with None asks a rank to end.
"""

import os
import select
import socket
import subprocess
import tempfile
from typing import Any, Sequence, Tuple

CUT_OFF = "the program that carries the messages"  # what `dyn` says when its socket is closed
LAST_SECONDS = 5.0  # that `dyn` has to end


def own_environment() -> "dict[str, str]":
    """Returns the environment without what MPI has told this process, which is of no use to a process that it starts."""
    return {name: value for name, value in os.environ.items() if not name.startswith(("OMPI_", "PMI_", "PMIX_", "DYN_SWEEP_CHANNEL"))}


def run_in_ranks(words: "Sequence[str]", text: str, environment: "dict[str, str]", comm: Any) -> Tuple[int, str]:
    """Runs the command on all ranks, with `text` as standard input of each. All ranks call it. Returns the same exit code and errors on all of them.

    If a rank's command ends without an agreement of all ranks, the commands of the other ranks are ended as well.
    """
    apart = comm.Dup()  # so that no message of the program is taken for one of these
    with tempfile.TemporaryFile() as source, tempfile.TemporaryFile() as errors:
        source.write(text.encode())
        source.seek(0)
        with _Relay(words, environment, apart, source, errors) as relay:
            relay.carry()
            errors.seek(0)
            ends = apart.allgather((relay.stopped, relay.command.returncode, errors.read().decode(errors="replace")))
    apart.Free()
    return _first_problem(ends)


def _first_problem(ends: "list[tuple[bool, int, str]]") -> Tuple[int, str]:
    """Takes the error of the rank that ended of its own accord, if it has told one."""
    if not any(code for _, code, _ in ends):
        return 0, ends[0][2]
    for _, code, text in sorted(ends, key=lambda end: end[0]):
        if code and "error: " in text and CUT_OFF not in text:
            return code, text
    rank, code = next((rank, code) for rank, (stopped, code, _) in enumerate(ends) if code and not stopped)
    how = f"was ended by signal {-code}" if code < 0 else f"ended with exit code {code}"
    return code, f"dyn: error: rank {rank}: dyn {how} (the chunks that are finished are kept; resume=True goes on)"


class _Relay:
    """The command of one rank, and its messages."""

    def __init__(self, words: "Sequence[str]", environment: "dict[str, str]", comm: Any, source: Any, errors: Any) -> None:
        self.comm, self.buffer, self.stopped = comm, b"", False
        self.sent: "list[Any]" = []  # requests of messages that are not yet received
        self.socket, theirs = socket.socketpair()
        with theirs:
            place = f"{comm.rank} {comm.size} {theirs.fileno()}"
            self.command = subprocess.Popen(words, stdin=source, stdout=subprocess.DEVNULL, stderr=errors, pass_fds=[theirs.fileno()],
                                            env={**environment, "DYN_SWEEP_CHANNEL": place})

    def __enter__(self) -> "_Relay":
        return self

    def __exit__(self, *_: object) -> None:
        self.socket.close()
        if self.command.poll() is None:
            self.command.kill()
        self.command.wait()

    def carry(self) -> None:
        """Carries messages until the commands of all ranks have ended."""
        pause, told, everybody = 0.0005, False, None
        while everybody is None or not everybody.Test():
            ended = self.command.poll() is not None  # so that what it wrote before is taken now
            moved = self.take() | self.give()
            self.sent = [request for request in self.sent if not request.test()[0]]
            if ended and not moved and not told:
                told = True
                if self.command.returncode and not self.stopped:
                    self.sent += [self.comm.issend((self.comm.rank, None), rank) for rank in range(self.comm.size) if rank != self.comm.rank]
            # A rank that has come here has no message on its way, so that none is left when all have.
            if told and not self.sent and everybody is None:
                everybody = self.comm.Ibarrier()
            # The socket wakes this process at once; for messages of other ranks it has to look. Only rank 0 gets some that it has not asked for.
            pause = 0.0005 if moved else min(2 * pause, 0.004 if self.comm.rank == 0 else 0.02)
            select.select([] if ended else [self.socket], [], [], pause)

    def take(self) -> bool:
        """Sends what `dyn` has written. Returns whether there was anything."""
        moved = False
        while not self.stopped and select.select([self.socket], [], [], 0)[0]:
            part = self.read()
            if not part:
                break
            self.buffer += part
            moved = True
        while b"\n" in self.buffer:
            head, _, rest = self.buffer.partition(b"\n")
            rank, size = map(int, head.split())
            if len(rest) < size:
                break
            self.sent.append(self.comm.issend((self.comm.rank, rest[:size]), rank))
            self.buffer = rest[size:]
        return moved

    def read(self) -> bytes:
        try:
            return self.socket.recv(1 << 16)
        except ConnectionError:
            return b""

    def give(self) -> bool:
        """Writes to `dyn` what other ranks have sent. Returns whether there was anything."""
        moved = False
        while self.comm.iprobe():
            rank, text = self.comm.recv()
            moved = True
            if text is None:
                self.stop()
            elif not self.stopped:
                try:
                    self.socket.sendall(b"%d %d\n%b" % (rank, len(text), text))
                except ConnectionError:
                    pass  # `dyn` has ended, and its exit code says why
        return moved

    def stop(self) -> None:
        """Ends the command, which finds its socket closed when it next looks."""
        if self.stopped or self.command.poll() is not None:
            return
        self.stopped = True
        self.socket.shutdown(socket.SHUT_RDWR)
        try:
            self.command.wait(LAST_SECONDS)
        except subprocess.TimeoutExpired:
            self.command.kill()
            self.command.wait()
