"""Record every cycle of a motion and analyse it; `station run` first."""

import numpy as np

from station.client import StationClient

with StationClient() as station:
    station.move_to("ready")
    goal = station.start_move({"panda_joint1": 0.5}, duration=2.0)
    samples = station.collect(2.5, f"controller_state/{goal.controller}")
    goal.wait()

error = samples["error"][:, 0]
period = np.diff(samples.stamp)
spectrum = np.abs(np.fft.rfft(error - error.mean()))
frequency = np.fft.rfftfreq(len(error), float(np.median(period)))
print(f"{len(error)} cycles, {samples.lost} lost, longest {1e3 * period.max():.1f} ms")
print(f"tracking error: rms {error.std():.2e} rad, worst {np.abs(error).max():.2e} rad")
print(f"strongest oscillation: {frequency[spectrum[1:].argmax() + 1]:.1f} Hz")
samples.frame().to_csv("motion.csv")
