"""Find better gains through the seat of an agent, and try each of them on a copy first.

The simulation is stepped and the station asks nobody (`agents: {approval: never}`):

    station run agent.yaml          # with: agents: {approval: never}
    station pause
    python examples/tune_as_an_agent.py
"""

import asyncio
import json

import numpy as np
from mcp import Client, StdioServerParameters

CONTROLLER = "effort_group_position_controller"
JOINT, STEP, SECONDS = 0, 0.1, 1.5


async def call(agent: Client, tool: str, **arguments: object) -> dict:
    """Call a tool of the station.

    Raises:
        RuntimeError: The station refuses, in its own words.
    """
    answer = await agent.call_tool(tool, arguments)
    if answer.is_error:
        raise RuntimeError(answer.content[0].text)
    return json.loads(answer.content[0].text)


async def error_of(
    agent: Client, gains: dict[str, float], target: list[float]
) -> float:
    """Rehearse a step with other gains; return the error, weighted by time."""
    steps = [
        {"kind": "gains", "changes": {CONTROLLER: gains}},
        {"kind": "set_point", "name": CONTROLLER, "values": target, "at": 0.05},
    ]
    told = await call(agent, "rehearse", body={"steps": steps, "seconds": SECONDS})
    if told["outcome"] != "completed":
        return np.inf  # a reflex, a limit: no candidate
    times, q = np.array(told["times"]), np.array(told["positions"])[:, JOINT]
    return float(np.trapezoid(times * abs(target[JOINT] - q), times))


async def tune(agent: Client) -> tuple[float, float, dict[str, float]]:
    """Return the weighted error before and after, and the gains now in force."""
    loaded = (await call(agent, "list_controllers"))["controllers"]
    if {c["name"]: c["state"] for c in loaded}[CONTROLLER] != "running":
        switch = {"start": [CONTROLLER], "strictness": "force_auto"}
        await call(agent, "switch_controllers", body=switch)
    gains = (await call(agent, "get_gains", name=CONTROLLER))["values"]
    joint = next(iter(gains)).partition("/")[0]
    best = {name: gains[name] for name in (f"{joint}/p", f"{joint}/d")}
    state = await call(agent, "joint_states")
    target = list(state["position"][:7])
    target[JOINT] += STEP
    first = least = await error_of(agent, best, target)
    factor = 1.5
    while factor > 1.1:  # one gain at a time, in ever smaller steps
        before = least
        for name in list(best):
            for change in (factor, 1.0 / factor):
                tried = {**best, name: best[name] * change}
                error = await error_of(agent, tried, target)
                if error < least:
                    least, best = error, tried
        if least == before:
            factor = factor**0.5
    await call(agent, "patch_gains", name=CONTROLLER, body={"values": best})
    return first, least, best


async def main() -> None:
    """Tune at the station of this machine."""
    async with Client(StdioServerParameters(command="station", args=["mcp"])) as agent:
        first, least, best = await tune(agent)
    print(f"weighted error {first:.4f} -> {least:.4f} with {best}")


if __name__ == "__main__":
    asyncio.run(main())
