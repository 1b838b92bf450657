# SPDX-License-Identifier: BSD-2-Clause
"""Ctrl-C while a simulation runs."""
import os
import signal
import threading


def interrupted_advance(test, simulator, time, watched=None):
    """Advances `simulator` to `time` in the main thread, and interrupts it once `watched`, by default the simulator itself, is in use."""
    watched = simulator if watched is None else watched

    def interrupt():
        while True:
            try:
                watched.time  # noqa: B018, refused while the simulation runs
            except RuntimeError:
                return os.kill(os.getpid(), signal.SIGINT)

    thread = threading.Thread(target=interrupt)
    with test.assertRaises(KeyboardInterrupt):
        thread.start()
        simulator.advance(time)
    thread.join()
