"""Verb `doctor`: is this machine fit for a station?"""

from argparse import Namespace
from dataclasses import asdict

from station.cli.machine_checks import CHECKS
from station.cli.output import say, say_json, say_table


def doctor(options: Namespace) -> int:
    """Print what was found and what to do; 1 when a station cannot run here."""
    findings = [check() for check in CHECKS]
    if options.json:
        say_json([asdict(finding) for finding in findings])
    else:
        say_table(
            ["check", "state", "finding"],
            [[f.check, f.state, f.finding] for f in findings],
        )
        for finding in findings:
            if finding.advice:
                say(f"{finding.check}: {finding.advice}")
    return int(any(finding.state == "problem" for finding in findings))
