"""The server's cycle: states, commands that count and that are lost, late commands.

Client and server are in one thread: bytes lie in the kernel until the server runs for
some cycles.
"""

import pytest

from station.core.franka import RobotMode
from station.hw.franka.fci.wire.robot_protocol import PANDA, Command
from tests.hw.franka.fci.server.robot_client import request
from tests.hw.franka.fci.server.server_bench import Bench, command, newest


@pytest.fixture
def bench():
    made = Bench()
    yield made
    made.close()


def test_a_state_arrives_every_cycle_with_the_next_number(bench):
    _, udp = bench.connect()
    bench.run(20)
    ids = [PANDA.state.unpack(udp.recv(4096))["message_id"] for _ in range(20)]
    assert ids == list(range(ids[0], ids[0] + 20))


def test_connection_that_breaks_in_a_motion_stops_the_arm(bench):
    tcp, udp = bench.connect()
    bench.move(tcp)
    state, server = newest(udp)
    udp.sendto(command(state["message_id"], state["q_d"]), server)
    bench.run(2)
    assert bench.arm.state.robot_mode is RobotMode.MOVE
    tcp.close()
    bench.run(2)
    assert bench.arm.state.robot_mode is RobotMode.IDLE
    tcp, _ = bench.connect()
    bench.move(tcp)


def test_state_with_an_error_goes_out_before_the_answer(bench, monkeypatch):
    """Clients tell the errors of the state that they have read last."""
    tcp, _ = bench.connect()
    bench.move(tcp)
    sent, port = [], bench.server._robot_port
    monkeypatch.setattr(port, "send", lambda data: data and sent.append("answer"))
    monkeypatch.setattr(port, "send_datagram", lambda data: sent.append(data[2364]))
    bench.arm.fail("joint_reflex")
    bench.run(2)
    assert sent == [RobotMode.REFLEX.value, "answer", RobotMode.REFLEX.value]


def test_reasons_of_refusals_and_reflexes_are_in_the_log(bench, caplog):
    tcp, _ = bench.connect()
    bench.move(tcp)
    tcp.sendall(request(Command.SET_JOINT_IMPEDANCE, 3, {"K_theta": [9.0] * 7}))
    bench.run(2)
    bench.arm.fail("joint_reflex")
    bench.run(5)
    told = [
        record.message for record in caplog.records if record.levelname == "WARNING"
    ]
    assert told == [
        "Robot: SET_JOINT_IMPEDANCE is refused: The arm moves.",
        "Robot: the arm has stopped by a reflex: joint_reflex (cycle 0)",
    ]


def test_commands_count_once_and_missing_ones_are_lost(bench):
    tcp, udp = bench.connect()
    bench.move(tcp)
    state, server = newest(udp)
    udp.sendto(command(state["message_id"], state["q_d"]), server)
    bench.run(4)
    counts = bench.server.counts
    assert (counts.commanded, counts.lost) == (4, 3)


def test_the_arms_time_waits_for_a_late_command_as_long_as_it_is_told():
    bench = Bench(patience=0.02)
    try:
        tcp, udp = bench.connect()
        bench.move(tcp)
        state, server = newest(udp)
        udp.sendto(command(state["message_id"], state["q_d"]), server)
        bench.run(1)
        started = bench.server._clock()
        bench.run(2)
        assert bench.server._clock() - started >= 0.04
        assert bench.server.counts.lost == 2
    finally:
        bench.close()


def test_change_that_nobody_waits_for_any_longer_is_not_made(bench):
    made = []
    assert bench.server.change(lambda: made.append("given up")).cancel()
    done = bench.server.change(lambda: made.append("wanted"))
    bench.run()
    assert done.done()
    assert made == ["wanted"]
