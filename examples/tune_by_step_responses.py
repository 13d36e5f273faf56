"""Sweep the gain p of a joint and plot its step responses; `station run` first."""

import matplotlib.pyplot as plt

from station.client import StationClient

NAME, MOVER = "effort_group_position_controller", "position_joint_trajectory_controller"
GAIN, STEP = "panda_joint1/p", 0.1

with StationClient() as station:
    station.move_to("ready")
    station.switch_controllers(start=[NAME], stop=[MOVER])
    here = [q or 0.0 for q in station.joint_states().position[:7]]
    before = station.gains(NAME).values[GAIN]
    for p in (100.0, 300.0, 600.0):
        station.set_gains(NAME, {GAIN: p})
        here[0] += STEP
        station.command(NAME, here)
        samples = station.collect(1.5, f"controller_state/{NAME}")
        error = samples["error"][:, 0] / STEP
        plt.plot(samples.stamp - samples.stamp[0], 1.0 - error, label=f"p = {p:g}")
        print(f"p = {p:g}: overshoot {max(0.0, -error.min()):.1%}")
    station.set_gains(NAME, {GAIN: before})
plt.xlabel("time [s]"), plt.ylabel("joint 1, part of the step"), plt.legend()
plt.savefig("step_responses.png")
