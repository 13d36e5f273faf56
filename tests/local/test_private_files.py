"""Files of the runtime directory; `test_runtime_file.py` tries most of them."""

import os
import subprocess
import sys

from station.local.private_files import is_alive, process_start


def test_a_process_is_alive_under_its_own_start_alone():
    me = os.getpid()

    assert is_alive(me, process_start(me))
    assert is_alive(me, "")
    assert not is_alive(me, "1")


def test_a_process_that_nobody_has_collected_has_ended():
    process = subprocess.Popen(
        [sys.executable, "-c", "import sys; sys.stdin.read()"], stdin=subprocess.PIPE
    )
    started = process_start(process.pid)
    assert is_alive(process.pid, started)

    process.stdin.close()
    os.waitid(os.P_PID, process.pid, os.WEXITED | os.WNOWAIT)

    assert process_start(process.pid) == ""
    assert not is_alive(process.pid, started)
    process.wait()
