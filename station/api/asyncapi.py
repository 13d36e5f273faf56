"""The AsyncAPI document: the frames of all streams, and their parameters."""

from pathlib import Path
from typing import Any

import yaml
from pydantic import BaseModel, TypeAdapter

import station as package
from station import wire
from station.api.streams.command_stream import DEFAULT_TIMEOUT, LONGEST_TIMEOUT
from station.api.streams.request import MAX_RATE, MIN_RATE
from station.api.streams.topics import (
    ControllerStateTopic,
    ControllersTopic,
    CycleTopic,
    EventsTopic,
    JointStatesTopic,
    LoopTopic,
    RobotStateTopic,
    SceneTopic,
    Topic,
)
from station.reports import Event, LoopReport, Report

Schema = dict[str, Any]

_REF = "#/components/schemas/"
_MODELS: tuple[type[BaseModel | Report], ...] = (
    wire.JointStates,
    wire.ControllerSample,
    wire.FrankaState,
    wire.Controllers,
    LoopReport,
    wire.StopState,
    wire.Scene,
    Event,
)
TOPICS: tuple[tuple[str, type[Topic], type[BaseModel | Report] | None], ...] = (
    ("joint_states", JointStatesTopic, wire.JointStates),
    ("controller_state/{controller}", ControllerStateTopic, wire.ControllerSample),
    ("robot_state/{arm_id}", RobotStateTopic, wire.FrankaState),
    ("controllers", ControllersTopic, wire.Controllers),
    ("loop", LoopTopic, None),
    ("scene", SceneTopic, wire.Scene),
    ("events", EventsTopic, Event),
)
"""Address, class and model of the data of each topic; None for several models."""

_LIMITS = {
    "min_rate": MIN_RATE,
    "max_rate": MAX_RATE,
    "default_timeout": DEFAULT_TIMEOUT,
    "longest_timeout": LONGEST_TIMEOUT,
}


def document() -> Schema:
    """Return the document; it describes frames with all their fields."""
    template = _template()
    sent = (*_MODELS, wire.CommandCounts)
    _, found = TypeAdapter.json_schemas(
        [
            *((one.__name__, "serialization", TypeAdapter(one)) for one in sent),
            (
                wire.CommandRequest.__name__,
                "validation",
                TypeAdapter(wire.CommandRequest),
            ),
        ],
        ref_template=_REF + "{model}",
    )
    schemas: Schema = found["$defs"]
    filled: Schema = template["document"]
    filled["info"]["version"] = package.__version__
    filled["components"]["schemas"] = schemas
    envelope = template["envelope"]
    first = {"boot_id": {"type": "string"}, "data": _object(template["hello"])}
    frames = {
        "hello": _message("Hello", "The first frame.", {**envelope, **first}),
    }
    for address, topic, model in TOPICS:
        name, _, member = address.partition("/")
        known = {} if model is None else schemas[model.__name__]["properties"]
        properties = {**template["data"], **known}
        forms = {"state": _object({key: properties[key] for key in topic.fields})}
        if topic.sample_fields:
            forms["cycles"] = _cycles(topic, properties, template)
        for form, data in forms.items():
            what = f"{name} {'at a rate' if form == 'state' else 'with rate=full'}"
            frames[f"{name}_{form}"] = _message(
                what, f"A frame of {what}.", {**envelope, "data": data}
            )
        parameter = member.strip("{}")
        filled["channels"][name] = {
            "address": f"/api/v1/streams/{address}",
            "title": name,
            "messages": {
                key: {"$ref": f"#/components/messages/{key}"}
                for key in ("hello", *(f"{name}_{form}" for form in forms))
            },
            "parameters": {parameter: {"description": f"Name: {parameter}."}}
            if parameter
            else {},
            "bindings": {
                "ws": {"query": {"type": "object", "properties": template["query"]}}
            },
        }
        filled["operations"][f"receive_{name}"] = {
            "action": "send",
            "channel": {"$ref": f"#/channels/{name}"},
            "summary": f"The station sends {name}.",
        }
    filled["components"]["messages"].update(frames)
    return filled


def _template() -> Schema:
    """Return the template, filled with the limits of rates and times."""
    text = Path(__file__).with_suffix(".yaml").read_text(encoding="utf-8")
    for name, limit in _LIMITS.items():
        text = text.replace(f"<{name}>", f"{limit:g}")
    template: Schema = yaml.safe_load(text)
    return template


def _message(title: str, summary: str, properties: Schema) -> Schema:
    return {"title": title, "summary": summary, "payload": _object(properties)}


def _object(properties: Schema) -> Schema:
    return {
        "type": "object",
        "properties": properties,
        "required": list(properties),
        "additionalProperties": False,
    }


def _cycles(topic: type[Topic], properties: Schema, template: Schema) -> Schema:
    heads = ("name",) if issubclass(topic, CycleTopic) else ("arm_id",)
    head = {key: properties[key] for key in heads if key in topic.sample_fields}
    sample = {
        "cycle": template["envelope"]["cycle"],
        **{key: properties[key] for key in topic.sample_fields if key not in head},
    }
    samples = {"type": "array", "items": _object(sample)}
    return _object({**head, "samples": samples, **template["batch"]})
