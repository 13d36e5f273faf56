"""All lessons are solved by who does the task, and failed with a hint by who does not.

The student is a script on a stepped station with the default arm.
"""

import math

import pytest

from station.app.composition import compose
from station.config import load_config
from station.core.control.switching import SwitchRequest
from station.core.franka.arms import Arms
from station.trials.bench_analysis import KeptRuns
from station.trials.errors import ExperimentError, LessonNotFoundError
from station.trials.lesson_attempts import LessonAttempts, open_book
from station.trials.live_bench import LiveBench
from station.wire.excitations import BenchRequest, Chirp, Relay, Step

GROUP = "effort_group_position_controller"
TRAJECTORY = "effort_joint_trajectory_controller"
STREAMING = "position_streaming_controller"
JOINT = "panda_joint4"
UNTIL_RESULT = 300


class Student:
    """Does what a person does on the page, by the objects behind its routes."""

    def __init__(self, station, folder):
        self.station = station
        self.runs = KeptRuns(folder / "runs")
        self.lessons = LessonAttempts(station, self.runs, folder / "lessons")
        self.bench = LiveBench(station, sleep=self.wait, now=lambda: 0.0)

    def wait(self, _=None, cycles=2):
        """Let time pass; the watching thread would look twice a second."""
        self.station.loop.step(cycles)
        if self.station.loop.cycle % UNTIL_RESULT < cycles:
            self.lessons.take()

    def rest(self, seconds):
        for _ in range(round(seconds * 10)):
            self.station.loop.step(100)
            self.lessons.take()

    def begin(self, name):
        self.lessons.begin(name, "ada")

    def start(self, name=GROUP):
        running = self.running()
        self.station.switch_controllers(
            SwitchRequest(start=(name,), stop=tuple(running))
        )
        self.rest(0.3)

    def stop(self):
        self.station.switch_controllers(SwitchRequest(stop=tuple(self.running())))
        self.rest(0.3)

    def running(self):
        return [
            c.name for c in self.station.controllers() if c.state.value == "running"
        ]

    def gains(self, **values):
        self.station.tuning.set_gains(
            GROUP, {f"{JOINT}/{key}": float(value) for key, value in values.items()}
        )

    def run(self, excitation, duration=2.0, controller=GROUP, **options):
        request = BenchRequest(excitation=excitation, duration=duration, **options)
        found = self.bench.measure(controller, request, lambda: None)
        self.rest(0.2)
        return self.runs.keep(found, None).metrics

    def step(self, duration=2.0, controller=GROUP):
        return self.run(Step(joint=JOINT, amplitude=0.1), duration, controller)

    def push(self, force, duration):
        arms = Arms(self.station.robots)
        arms.apply_force("panda", "panda_hand", [0.0, 0.0, force], [0.0] * 3, duration)

    def load(self, mass):
        _, call = self.station.robots.find_service("panda", "set_load")
        inertia = [0.001 * mass * (i % 4 == 0) for i in range(9)]
        self.station.robots.run(
            lambda: call(
                mass=mass, F_x_center_load=[0.0, 0.0, 0.1], load_inertia=inertia
            )
        )


@pytest.fixture(scope="module")
def panda():
    return compose(load_config()).station


@pytest.fixture
def student(panda, tmp_path):
    """Somebody in front of an arm that was just put back."""
    before = panda.tuning.all_gains()
    panda.robots.recover_all()
    running = tuple(c.name for c in panda.controllers() if c.state.value == "running")
    panda.switch_controllers(SwitchRequest(stop=running))
    panda.simulation.reset()
    panda.loop.step(50)
    student = Student(panda, tmp_path)
    yield student
    panda.robots.recover_all()
    panda.tuning.set_many(before)
    student.stop()
    student.load(0.0)


def p_alone(student, *, right):
    student.start()
    student.gains(p=50)
    student.step()
    student.gains(p=100, i=0 if right else 100, i_clamp_max=4, i_clamp_min=-4)
    return {"steady_error": 1e3 * student.step()["steady_error"]}


def damping(student, *, right):
    student.start()
    student.gains(d=10)
    student.step()
    student.gains(**({"d": 40} if right else {"p": 50, "d": 20}))
    student.step()


def integral_and_windup(student, *, right):
    student.start()
    clamp = 4 if right else 0
    student.gains(i=200, i_clamp_max=clamp, i_clamp_min=-clamp)
    student.step(4.0)


def gravity_compensation(student, *, right):
    student.load(1.0)
    student.start()
    student.step()
    student.stop()
    if right:
        student.load(0.0)
    else:
        student.gains(p=400)
    student.start()
    student.step()


def limits_and_jerk(student, *, right):
    student.start(STREAMING)
    student.step(1.0, STREAMING)
    a, j, way = 4.0, 60.0, 0.1
    ramp = a / j
    speed = a * (math.sqrt(ramp**2 + 4.0 * way / a) - ramp) / 2.0
    return {"speed": speed if right else math.sqrt(a * way)}


def impedance_and_contact(student, *, right):
    student.start()
    student.gains(p=50 if right else 200)
    student.push(8.0, 1.0)
    student.rest(1.5)


def reflex_and_recovery(student, *, right):
    student.start()
    student.push(100.0, 0.2)
    student.rest(0.6)
    if right:
        student.station.robots.recover_all()
        student.rest(0.3)
        student.start()


def switching_without_a_jump(student, *, right):
    student.start()
    for name in (TRAJECTORY, GROUP):
        if not right:
            student.stop()
        student.start(name)


def identification(student, *, right):
    student.start()
    if not right:
        student.step()
        return {"inertia": 1.0}
    chirp = Chirp(joint="panda_joint7", amplitude=0.01, first=3.0, last=15.0)
    return {"inertia": student.run(chirp, 6.0)["inertia"]}


def tuning_by_relay(student, *, right):
    student.start()
    relay = Relay(joint=JOINT, amplitude=0.1, hysteresis=0.0005)
    student.run(relay, 4.0, relay_gain=50.0)
    run = student.runs.get(student.runs.list()[-1].name)
    (wanted,) = [p.gains for p in run.proposals if p.rule == "no_overshoot"]
    if not right:
        wanted = {f"{JOINT}/p": 300.0, f"{JOINT}/d": 20.0}
    student.station.tuning.set_gains(GROUP, wanted)
    student.step()


LESSONS = {
    p_alone: "An integral goes on pushing",
    damping: "leave p at 200 and raise d",
    integral_and_windup: "The clamp is 0",
    gravity_compensation: "hides the error of the model",
    limits_and_jerk: "Without the jerk limit",
    impedance_and_contact: "four times as stiff",
    reflex_and_recovery: "still in reflex",
    switching_without_a_jump: "Do not stop first",
    identification: "Run a chirp",
    tuning_by_relay: "Guessing is what the relay spares you",
}
"""What a student does, and what tells the one who did the obvious wrong thing."""


@pytest.mark.parametrize("act", LESSONS, ids=lambda act: act.__name__)
def test_a_lesson_is_solved_by_who_does_the_task(student, act):
    name = act.__name__
    student.begin(name)

    answers = act(student, right=True)
    result = student.lessons.check(name, "ada", answers or {})

    assert [v for v in result.verdicts if not v.is_met] == []
    assert result.is_solved
    solved = {
        one.name for one in student.lessons.lessons("Ada").lessons if one.is_solved
    }
    assert solved == {name}
    assert not any(one.is_solved for one in student.lessons.lessons("bob").lessons)


@pytest.mark.long
@pytest.mark.parametrize("act", LESSONS, ids=lambda act: act.__name__)
def test_the_obvious_wrong_thing_fails_with_a_hint(student, act):
    name = act.__name__
    student.begin(name)

    answers = act(student, right=False)
    result = student.lessons.check(name, "ada", answers or {})

    assert not result.is_solved
    hints = " ".join(verdict.hint for verdict in result.verdicts)
    assert LESSONS[act] in hints
    assert not any(one.is_solved for one in student.lessons.lessons("ada").lessons)


def test_there_are_ten_lessons_in_order():
    names = list(open_book().lessons)
    assert names == [act.__name__ for act in LESSONS]
    assert open_book().unusable == ()


LESSON = """
title: My own
controllers: [arm]
joint: j
text: Move.
checks:
  - {value: watched.reflexes, at_most: 0, says: Nothing broke, hint: Be gentle.}
"""


def test_a_teachers_lesson_is_the_last_and_a_wrong_one_is_told(tmp_path):
    (tmp_path / "own.yaml").write_text(LESSON)
    (tmp_path / "bad.yaml").write_text(LESSON.replace("watched.reflexes", "luck"))
    (tmp_path / "worse.yaml").write_text("title: [")

    book = open_book(tmp_path)

    assert list(book.lessons)[-1] == "own"
    assert len(book.lessons) == 11
    assert len(book.unusable) == 2
    assert "'luck' is no figure" in " ".join(book.unusable)
    with pytest.raises(LessonNotFoundError, match="no lesson 'bad'"):
        book.get("bad")


def test_a_lesson_that_was_not_begun_is_not_checked(student):
    with pytest.raises(ExperimentError, match="has not been begun"):
        student.lessons.check("damping", "ada", {})


def test_a_run_from_before_the_lesson_is_not_the_students(student):
    student.start()
    student.step(0.3)
    student.begin("damping")
    verdicts = student.lessons.check("damping", "ada", {}).verdicts
    assert all(verdict.value is None for verdict in verdicts)
    assert verdicts[0].hint.startswith("Set d to 10")
    assert {verdict.hint for verdict in verdicts[1:]} == {"Not measured yet."}
