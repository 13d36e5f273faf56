"""Verbs for the robot: its interfaces, and what limits its joints."""

from argparse import Namespace
from typing import TYPE_CHECKING

from station.cli.connection import open_client
from station.cli.output import say, say_model, say_table

if TYPE_CHECKING:
    from station.wire import Hardware, HardwareLimits


def list_hardware_interfaces(options: Namespace) -> int:
    """Print what controllers can claim, and who claims it."""
    with open_client(options) as client:
        hardware = client.hardware()
    if options.json:
        say_model(hardware)
        return 0
    rows = [
        [resource.name, interface.name, ", ".join(resource.claimed_by) or "-"]
        for interface in hardware.interfaces
        for resource in interface.resources
    ]
    say_table(["resource", "hardware interface", "claimed by"], rows)
    if options.verbose:
        _say_details(hardware)
    return 0


def _say_details(hardware: "Hardware") -> None:
    say("")
    say_table(
        ["joint", "position", "velocity", "effort", "soft", "from"],
        [_limits_row(limits) for limits in hardware.limits],
    )
    if hardware.transmissions:
        say("")
        say_table(
            ["transmission", "type", "actuators", "joints"],
            [
                [t.name, t.type, ", ".join(t.actuators), ", ".join(t.joints)]
                for t in hardware.transmissions
            ],
        )
    if hardware.repairs:
        say("")
        say_table(
            ["repaired", "problem", "was", "is"],
            [[r.element, r.problem, r.old or "-", r.new] for r in hardware.repairs],
        )
    if hardware.clamps:
        say("")
        say_table(
            ["clamped joint", "hardware interface", "count", "asked", "given", "why"],
            [
                [
                    clamp.joint,
                    clamp.hardware_interface,
                    str(clamp.count),
                    _number(clamp.asked),
                    _number(clamp.given),
                    clamp.reason,
                ]
                for clamp in hardware.clamps
            ],
        )


def _limits_row(limits: "HardwareLimits") -> list[str]:
    soft = limits.soft_limits
    kinds = ("position", "velocity", "effort", "soft")
    sources = dict.fromkeys(
        limits.sources[kind] for kind in kinds if kind in limits.sources
    )
    return [
        limits.joint,
        _range(limits.min_position, limits.max_position),
        _number(limits.max_velocity),
        _number(limits.max_effort),
        "-" if soft is None else _range(soft.min_position, soft.max_position),
        ", ".join(sources) or "-",
    ]


def _range(low: float | None, high: float | None) -> str:
    return "-" if low is None or high is None else f"{low:g} to {high:g}"


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:g}"
