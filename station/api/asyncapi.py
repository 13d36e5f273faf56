"""The AsyncAPI document: the frames of all streams, and what a client may ask for."""

from typing import Any

from pydantic import BaseModel, TypeAdapter

import station as package
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
from station.wire import (
    CommandCounts,
    CommandRequest,
    Controllers,
    ControllerSample,
    FrankaState,
    JointStates,
    Scene,
    StopState,
)

Schema = dict[str, Any]

VERSION = "3.0.0"
_REF = "#/components/schemas/"
_MODELS: tuple[type[BaseModel | Report], ...] = (
    JointStates,
    ControllerSample,
    FrankaState,
    Controllers,
    LoopReport,
    StopState,
    Scene,
    Event,
)
TOPICS: tuple[tuple[str, type[Topic], type[BaseModel | Report] | None], ...] = (
    ("joint_states", JointStatesTopic, JointStates),
    ("controller_state/{controller}", ControllerStateTopic, ControllerSample),
    ("robot_state/{arm_id}", RobotStateTopic, FrankaState),
    ("controllers", ControllersTopic, Controllers),
    ("loop", LoopTopic, None),
    ("scene", SceneTopic, Scene),
    ("events", EventsTopic, Event),
)
"""Address, topic, and the model of its data; None where it has several."""

_OWN: Schema = {
    "arm_id": {"type": "string", "description": "Name of the arm."},
    "running": {
        "type": "array",
        "items": {"type": "string"},
        "description": "Names of the controllers that run.",
    },
    "period": {"type": "number", "description": "Time since the cycle before [s]."},
    "stamp": {"type": "number", "description": "Station time [s]."},
    "robot_mode": {"type": "string", "description": "Mode of the robot in one word."},
    "loop": {"$ref": f"{_REF}LoopReport"},
    "stop": {"$ref": f"{_REF}StopState"},
}
_ENVELOPE: Schema = {
    "topic": {"type": "string", "description": "What the frame is about."},
    "seq": {
        "type": "integer",
        "minimum": 0,
        "description": "Counts the frames of the stream; a gap is frames that this "
        "client was too slow for. With rate=full the newest cycle of the batch.",
    },
    "epoch": {"type": "integer", "minimum": 1, "description": "Epoch of the data."},
    "cycle": {"type": "integer", "minimum": 0, "description": "Cycle of the data."},
    "stamp": {"type": "number", "description": "Station time of the data [s]."},
}
_BATCH: Schema = {
    "lost": {
        "type": "integer",
        "minimum": 0,
        "description": "Cycles that were overwritten before they could be sent.",
    },
    "skipped": {
        "type": "integer",
        "minimum": 0,
        "description": "Deadlines that the loop missed, so that there was no cycle.",
    },
}
_QUERY: Schema = {
    "rate": {
        "description": f"Frames per second, {MIN_RATE} to {MAX_RATE} [Hz], or `full` "
        "for every cycle, in batches.",
        "examples": ["30", "full"],
        "type": "string",
    },
    "fields": {
        "description": "Only these keys of `data`, or of each sample; commas between.",
        "examples": ["stamp,position"],
        "type": "string",
    },
    "format": {
        "description": "How frames are written.",
        "enum": ["json", "msgpack"],
        "default": "json",
        "type": "string",
    },
    "ticket": {
        "description": "A ticket of POST /api/v1/stream-tickets, for browsers.",
        "type": "string",
    },
}


def document() -> Schema:
    """Return the document; the frames are those without `fields`."""
    sent = (*_MODELS, CommandCounts)
    _, found = TypeAdapter.json_schemas(
        [
            *((one.__name__, "serialization", TypeAdapter(one)) for one in sent),
            (CommandRequest.__name__, "validation", TypeAdapter(CommandRequest)),
        ],
        ref_template=_REF + "{model}",
    )
    schemas: Schema = found["$defs"]
    messages: Schema = {"hello": _message("Hello", "The first frame.", _hello())}
    channels: Schema = {}
    operations: Schema = {}
    for address, topic, model in TOPICS:
        name = address.partition("/")[0]
        known = {} if model is None else schemas[model.__name__]["properties"]
        properties = {**_OWN, **known}
        forms = {"state": _state(topic, properties)}
        if topic.sample_fields:
            forms["cycles"] = _cycles(topic, properties)
        for form, data in forms.items():
            what = f"{name} {'at a rate' if form == 'state' else 'with rate=full'}"
            messages[f"{name}_{form}"] = _message(what, f"A frame of {what}.", data)
        channels[name] = {
            "address": f"/api/v1/streams/{address}",
            "title": name,
            "messages": {
                key: {"$ref": f"#/components/messages/{key}"}
                for key in ("hello", *(f"{name}_{form}" for form in forms))
            },
            "parameters": _address_parameters(address),
            "bindings": {"ws": {"query": {"type": "object", "properties": _QUERY}}},
        }
        operations[f"receive_{name}"] = {
            "action": "send",
            "channel": {"$ref": f"#/channels/{name}"},
            "summary": f"The station sends {name}.",
        }
    messages["set_point"] = {
        "title": "Set-point",
        "summary": "A set-point, or an array of its numbers alone.",
        "payload": {"$ref": f"{_REF}CommandRequest"},
    }
    messages["command_counts"] = {
        "title": "Counts",
        "summary": "What became of the set-points that were received.",
        "payload": {"$ref": f"{_REF}CommandCounts"},
    }
    channels["command"] = _command_channel()
    for action, name in (("receive", "set_point"), ("send", "command_counts")):
        operations[f"{action}_{name}"] = {
            "action": action,
            "channel": {"$ref": "#/channels/command"},
            "summary": f"The station {action}s {messages[name]['title']}.",
            "messages": [{"$ref": f"#/channels/command/messages/{name}"}],
        }
    return {
        "asyncapi": VERSION,
        "info": {
            "title": "Control station, streams",
            "version": package.__version__,
            "description": "WebSocket streams. Tokens are sent as `Authorization: "
            "Bearer <token>`; /api/v1/openapi.json has everything else.",
        },
        "defaultContentType": "application/json",
        "channels": channels,
        "operations": operations,
        "components": {"messages": messages, "schemas": schemas},
    }


def _command_channel() -> Schema:
    query = {
        "timeout": {
            "description": "Silence after which the last set-point expires [s], up to "
            f"{LONGEST_TIMEOUT:g}.",
            "default": str(DEFAULT_TIMEOUT),
            "type": "string",
        },
        **{key: _QUERY[key] for key in ("format", "ticket")},
    }
    return {
        "address": "/api/v1/streams/command/{controller}",
        "title": "command",
        "messages": {
            key: {"$ref": f"#/components/messages/{key}"}
            for key in ("set_point", "command_counts")
        },
        "parameters": {"controller": {"description": "Name: controller."}},
        "bindings": {"ws": {"query": {"type": "object", "properties": query}}},
    }


def _address_parameters(address: str) -> Schema:
    _, _, member = address.partition("/")
    name = member.strip("{}")
    return {name: {"description": f"Name: {name}."}} if name else {}


def _message(title: str, summary: str, data: Schema) -> Schema:
    extra = {"boot_id": {"type": "string"}} if title == "Hello" else {}
    return {
        "title": title,
        "summary": summary,
        "payload": _object({**_ENVELOPE, **extra, "data": data}),
    }


def _object(properties: Schema) -> Schema:
    return {
        "type": "object",
        "properties": properties,
        "required": list(properties),
        "additionalProperties": False,
    }


def _hello() -> Schema:
    states = {"anyOf": [{"$ref": f"{_REF}JointStates"}, {"type": "null"}]}
    return _object({
        "joint_states": states,
        "controllers": {
            "type": "array",
            "items": {"$ref": f"{_REF}ControllerState"},
        },
        "stop": {"$ref": f"{_REF}StopState"},
    })


def _state(topic: type[Topic], properties: Schema) -> Schema:
    return _object({key: properties[key] for key in topic.fields})


def _cycles(topic: type[Topic], properties: Schema) -> Schema:
    heads = ("name",) if issubclass(topic, CycleTopic) else ("arm_id",)
    head = {key: properties[key] for key in heads if key in topic.sample_fields}
    sample = {
        "cycle": _ENVELOPE["cycle"],
        **{key: properties[key] for key in topic.sample_fields if key not in head},
    }
    samples = {"type": "array", "items": _object(sample)}
    return _object({**head, "samples": samples, **_BATCH})
