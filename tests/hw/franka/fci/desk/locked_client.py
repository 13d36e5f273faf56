"""A program of panda-python that begins a motion; prints libfranka's words as JSON.

Usage: python locked_client.py HOST
"""

import json
import sys

import panda_py


def main(host):
    """Connect, tell the mode, and turn a joint."""
    told = {}
    try:
        panda = panda_py.Panda(host)
        told["mode"] = str(panda.get_state().robot_mode)
        q = panda.q
        q[6] += 0.05
        told["arrived"] = panda.move_to_joint_position(q)
        panda.raise_error()
    except RuntimeError as error:
        told["error"] = str(error)
    sys.stdout.write(json.dumps(told))


if __name__ == "__main__":
    main(sys.argv[1])
