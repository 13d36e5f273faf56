"""A process that plays the part of an experiment, as its first argument says.

`quick` begins, tells progress and ends; `refuse` refuses; `die` is killed after it has
begun; `linger` closes its output and lives on; `wait` ends when it is interrupted;
`silent` ends without a word. With two more arguments the file of the experiment, the
first, becomes a copy of the second. Without them the file has the setup of the order;
to write that the station is imported, which takes longer than all the rest.
"""

import json
import os
import shutil
import signal
import sys


def tell(**facts):
    """Write one line."""
    sys.stdout.write(f"{json.dumps(facts)}\n")
    sys.stdout.flush()


def main(what, file=None, empty=None):
    """Play the part."""
    # As the process of an experiment does: what runs in the background ignores it.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    order = json.loads(sys.stdin.readline())
    name = order["request"]["name"]
    if what == "silent":
        sys.exit(7)
    if what == "refuse":
        refused = {
            "code": "impossible_range",
            "message": "Parameter 'load' cannot be -1.",
            "remedy": "Choose more.",
            "details": {"parameter": "load"},
        }
        tell(refused=refused)
        sys.exit(1)
    if file is not None:
        shutil.copy(empty, file)
    else:
        _create(name, order)
    tell(begun=name)
    told = {"ended": 1, "total": 2, "failed": 0, "resumed": 0, "reason": ""}
    tell(progress=told)
    if what == "die":
        os.kill(os.getpid(), signal.SIGKILL)
    if what == "linger":
        os.close(1)
        signal.pause()
    if what == "wait":
        try:
            signal.pause()
        except KeyboardInterrupt:
            tell(end={"state": "cancelled", "reason": ""})
        return
    tell(progress={**told, "ended": 2})
    tell(end={"state": "done", "reason": "No trial was better in 15 generations."})


def _create(name, order):
    from station.trials.results import Results, file_of
    from station.trials.trial import Setup

    request = order["request"]
    plan = {"trials": request["trials"], "controller": request["controller"]}
    Results.create(file_of(name), request["kind"], Setup(order["setup"]), plan).close()


if __name__ == "__main__":
    main(*sys.argv[1:])
