"""Tune the gains of a joint in simulation, on all processors; no station has to run."""

from station.experiments.pools import make_pool
from station.experiments.tuning import Search, tune
from station.trials.objective import Bound, Objective
from station.trials.results import Results, file_of
from station.trials.trial import Script, Setup, Trial
from station.wire.excitations import Step

NAME, JOINT = "effort_group_position_controller", "panda_joint1"
GAINS = {f"gains/{NAME}/{JOINT}/p": 120.0, f"gains/{NAME}/{JOINT}/d": 60.0}

if __name__ == "__main__":
    commands = [Step(joint=JOINT, amplitude=0.1)]
    script = Script(controller=NAME, duration=1.0, commands=commands)
    # A step that is followed faster takes more effort: allow half as much again.
    bounds = [Bound("effort_peak", 1.5, is_relative=True), Bound("violations", 0.0)]
    first, objective = (
        Trial(Setup.load(), script, GAINS),
        Objective({"rms_error": 1.0}, bounds),
    )
    file = file_of("tune-a-joint")
    with Results.create(file, "tune", first.setup, {}) as results, make_pool() as pool:
        tuned = tune(first, GAINS, objective, Search(trials=40), results, pool)
    print(f"error {tuned.best_cost:.0%} of the first; {dict(tuned.best.parameters)}")
