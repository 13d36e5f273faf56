"""Verbs `bench` and `lesson`: test a joint, show kept runs, and check exercises."""

import getpass
from argparse import Namespace
from typing import TYPE_CHECKING

from station.cli.connection import open_client
from station.cli.errors import UsageError, explain_fields
from station.cli.output import answer, answer_table, say, say_json, say_table
from station.cli.parser import check_words, read_number, unique
from station.cli.verbs.gains import answer_change

if TYPE_CHECKING:
    from station.cli.parser import Parser
    from station.client import StationClient
    from station.wire.excitations import BenchResponse, GainProposal, Lesson

_KINDS = ("step", "sine", "chirp", "multisine", "relay")
_RUNS = ("list", "show", "delete", "apply")
_SIZES = {"step": 0.1, "sine": 0.1, "chirp": 0.02, "multisine": 0.05, "relay": 0.1}
_TEST = "name controller amplitude duration keep_as recording incident"
_USES = {
    "step": _TEST,
    **dict.fromkeys(("sine", "chirp", "multisine"), f"{_TEST} frequency"),
    "relay": f"{_TEST} hysteresis relay_gain",
    "list": "",
    "show": "name",
    "delete": "name",
    "apply": "name rule",
}
"""Arguments that each action uses."""
_TYPED = {
    "joint": "NAME",
    "name": "--keep-as",
    "run": "--keep-as",
    **dict.fromkeys(("frequencies", "first", "last"), "--frequency"),
}
"""What a user types for the fields whose options have other names."""
_FREQUENCIES = (0.5, 0.9, 1.5, 2.3, 3.7, 5.9)


def add_bench(parser: "Parser") -> None:
    """Add the arguments of `bench`."""
    add = parser.add_argument
    add("action", choices=(*_KINDS, *_RUNS))
    add(
        "name",
        nargs="?",
        metavar="NAME",
        help="the joint of a test; the run to show, delete or apply",
    )
    add(
        "--controller",
        default="effort_group_position_controller",
        help="what moves the joint, and runs",
    )
    add("--amplitude", type=float, metavar="A", help="[rad or m]")
    add("--duration", type=float, default=4.0, metavar="S")
    add(
        "--frequency",
        nargs="+",
        type=float,
        metavar="HZ",
        help="of a sine; of all sines of a multisine; first and last of a chirp",
    )
    add("--hysteresis", type=float, default=0.0005, help="of a relay")
    add(
        "--relay-gain",
        type=float,
        metavar="P",
        help="p of the joint during a relay test, with i and d 0, so that gains can be "
        "proposed; without it the gains in force stay",
    )
    add("--keep-as", metavar="RUN", help="name of the run")
    add("--rule", help="apply: the rule, e.g. tyreus_luyben_pid")
    add("--recording", metavar="ID", help="read a part of it; the robot does not move")
    add("--incident", metavar="ID", help="likewise")
    add("--begin", type=float, metavar="S", help="of the part")
    add("--end", type=float, metavar="S", help="of the part")


def bench(options: Namespace) -> int:
    """Excite a joint, read a part of a recording as a test, or show kept runs.

    Raises:
        UsageError: There are too few or too many words.
    """
    if (options.name is None) != (options.action == "list"):
        raise UsageError(
            f"`bench {options.action}` needs "
            f"{'no more words' if options.action == 'list' else 'a name'}.",
            remedy="station bench relay panda_joint1 --relay-gain 50, station bench "
            "list, station bench apply RUN --rule tyreus_luyben_pid.",
        )
    # A part of a recording is read between the lowest and the highest frequency.
    part = "frequency begin end" if options.recording or options.incident else ""
    check_words(options, {one: f"{used} {part}" for one, used in _USES.items()})
    if options.recording and options.incident:
        raise UsageError(
            "Both a recording and an incident are named.",
            remedy="Leave out --recording or --incident.",
        )
    with open_client(options) as client:
        if options.action == "list":
            return _list(client, options)
        if options.action == "delete":
            found = client.bench_runs.delete(options.name)
        elif options.action in _RUNS:
            found = client.bench_runs.get(options.name)
        else:
            found = _measure(client, options)
        if options.action == "apply":
            return _apply(client, found, options)
    if options.json:
        say_json(found)
    else:
        _tell(found)
    return 0


def _measure(client: "StationClient", options: Namespace) -> "BenchResponse":
    """Return a test of the robot, or of a part of a recording.

    Raises:
        UsageError: The frequencies do not fit the kind of test.
    """
    from pydantic import TypeAdapter, ValidationError

    from station.wire.excitations import Excitation, PartRequest

    kind, given = options.action, options.frequency
    wanted = {"sine": 1, "chirp": 2}.get(kind)
    if given and wanted not in {len(given), None}:
        raise UsageError(
            f"A {kind} has {wanted} frequencies; {len(given)} are given.",
            remedy="--frequency 1.5 for a sine, --frequency 0.5 8 for a chirp.",
        )
    values: dict[str, object] = {}
    frequencies = given or {"sine": (1.0,), "chirp": (0.5, 8.0)}.get(kind, _FREQUENCIES)
    if options.recording or options.incident:
        store = client.recordings if options.recording else client.incidents
        part = PartRequest(
            controller=options.controller,
            joint=options.name,
            kind=kind,
            begin=options.begin,
            end=options.end,
            low=min(frequencies),
            high=max(frequencies),
            name=options.keep_as,
        )
        return store.bench(options.recording or options.incident, part)
    if kind == "sine":
        values["frequency"] = frequencies[0]
    elif kind == "chirp":
        values["first"], values["last"] = frequencies
    elif kind == "multisine":
        values["frequencies"] = frequencies
    elif kind == "relay":
        values["hysteresis"] = options.hysteresis
    size = _SIZES[kind] if options.amplitude is None else options.amplitude
    data = {"kind": kind, "joint": options.name, "amplitude": size, **values}
    try:
        excitation = TypeAdapter(Excitation).validate_python(data)
        return client.bench(
            options.controller,
            excitation,
            duration=options.duration,
            relay_gain=options.relay_gain,
            run=options.keep_as,
        )
    except ValidationError as error:
        typed = options.typed | _TYPED
        reasons = "; ".join(explain_fields(error, typed, kind))
        raise UsageError(
            f"This is no {kind} test: {reasons}.", remedy="station bench --help"
        ) from error


def _list(client: "StationClient", options: Namespace) -> int:
    runs = client.bench_runs.list()
    rows = [[r.name, r.kind, r.joint, r.controller, r.created_at] for r in runs]
    headers = ["run", "kind", "joint", "controller", "measured"]
    return answer_table(options, runs, headers, rows, "No run is kept.")


def _tell(run: "BenchResponse") -> None:
    say(f"{run.name}: {run.kind} of {run.joint} by {run.controller}")
    units = run.units
    rows = [[k, f"{v:.4g}", units.get(k, "") or "-"] for k, v in run.metrics.items()]
    say_table(["figure", "value", "unit"], rows)
    if run.proposals:
        say("")
        names = list(run.proposals[0].gains)
        say_table(
            ["rule", *names],
            [[p.rule, *(f"{p.gains[n]:g}" for n in names)] for p in run.proposals],
        )
        say(f"Put one into force: station bench apply {run.name} --rule RULE.")


def _apply(client: "StationClient", run: "BenchResponse", options: Namespace) -> int:
    """Put the gains of a rule into force.

    Raises:
        UsageError: The run proposes nothing, or there is no such rule.
    """
    rules: dict[str, GainProposal] = {one.rule: one for one in run.proposals}
    if options.rule not in rules:
        raise UsageError(
            f"The run '{run.name}' has no gains by the rule {options.rule!r}.",
            remedy=f"--rule with one of: {', '.join(rules)}."
            if rules
            else "Only a relay test with --relay-gain proposes gains.",
        )
    rule = rules[options.rule]
    change = client.set_gains(run.controller, rule.gains)
    notes = filter(None, (rule.note, *change.notes))
    return answer_change(options, change, rule.gains, notes)


def add_lesson(parser: "Parser") -> None:
    """Add the arguments of `lesson`."""
    add = parser.add_argument
    add("action", choices=("list", "show", "begin", "check"))
    add("name", nargs="?", metavar="NAME", help="the lesson")
    add("answers", nargs="*", metavar="ANSWER=VALUE", help="check: worked-out numbers")
    add(
        "--person",
        default=getpass.getuser(),
        help="whose progress is kept; the user of this machine when left out",
    )


def lesson(options: Namespace) -> int:
    """List or show lessons, begin one, or check it; return 1 if it is not solved.

    Raises:
        UsageError: There are too few or too many words.
    """
    needs_name = options.action != "list"
    if (options.name is not None) != needs_name or (
        options.answers and options.action != "check"
    ):
        raise UsageError(
            f"The words after `lesson {options.action}` are too few or too many.",
            remedy="station lesson list, station lesson begin p_alone, "
            "station lesson check p_alone steady_error=5.1.",
        )
    answers = unique(map(read_number, options.answers))
    with open_client(options) as client:
        if options.action == "check":
            return _check_lesson(client, options, answers)
        if options.action == "list":
            return _list_lessons(client, options)
        if options.action == "begin":
            found = client.lessons.begin(options.name, options.person)
        else:
            found = _find_lesson(client, options)
    asked = (f"Answer: {one.name}=… [{one.unit}] {one.label}" for one in found.answers)
    return answer(options, found, f"{found.title}\n\n{found.text}", *asked)


def _find_lesson(client: "StationClient", options: Namespace) -> "Lesson":
    """Return a lesson.

    Raises:
        UsageError: There is no such lesson.
    """
    known = {one.name: one for one in client.lessons.list(options.person).lessons}
    if options.name not in known:
        raise UsageError(
            f"There is no lesson {options.name!r}.",
            remedy=f"There are: {', '.join(known)}.",
        )
    return known[options.name]


def _list_lessons(client: "StationClient", options: Namespace) -> int:
    found = client.lessons.list(options.person)
    rows = [
        ["✔" if one.is_solved else "", one.name, one.title] for one in found.lessons
    ]
    answer_table(options, found.lessons, ["", "lesson", "title"], rows)
    for reason in () if options.json else found.unusable:
        say(f"Left out: {reason}")
    return 0


def _check_lesson(
    client: "StationClient", options: Namespace, answers: dict[str, float]
) -> int:
    result = client.lessons.check(options.name, options.person, answers)
    lines = []
    for one in result.verdicts:
        lines.append(f"{'✔' if one.is_met else '✖'} {one.says}")
        lines += [f"  {one.hint}"] if one.hint else []
    end = "Solved." if result.is_solved else "Not solved yet."
    answer(options, result, *lines, end)
    return 0 if result.is_solved else 1
