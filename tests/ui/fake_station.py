"""A small station that speaks the API's contract, for tests of its client's side.

Joints follow their set-points at once, controllers are what was loaded, and every
request is remembered.
"""

import asyncio
import json
import time

from starlette.applications import Starlette
from starlette.responses import JSONResponse
from starlette.routing import Route, WebSocketRoute
from starlette.websockets import WebSocketDisconnect

from tests.ui.fake_answers import (
    HARDWARE,
    JOINTS,
    LOOP,
    FakeController,
    arm_report,
    gain_schema,
    problem,
)
from tests.ui.served import Served

OPERATOR = "operator-token"
VIEWER = "viewer-token"
GROUP_TYPE = "effort_controllers/JointGroupPositionController"
HERE = [0.3, 0.0, 0.5, 1.0, 0.0, 0.0, 0.0]
POSE = ("x", "y", "z", "qx", "qy", "qz", "qw")
TWIST = ("vx", "vy", "vz", "wx", "wy", "wz")
START = [0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785]
SIMULATION = {
    "paused": False,
    "real_time_factor": 1.0,
    "time": 2.5,
    "steps_due": 0,
}


class FakeStation:
    """The station; `url` is where it answers while the context is open."""

    def __init__(self):
        self.positions = list(START)
        self.desired = list(START)
        self.pose = list(HERE)
        self.controllers = {}
        self.stop_state = "armed"
        self.arms = {}  # arm_id to mode
        self.epoch = 1
        self.simulation = dict(SIMULATION)
        self.objects = []
        self.requests = []
        self.boot_id = "boot-1"
        self.message = ""
        self.url = ""

    def __enter__(self):
        self._served = Served(self.app()).__enter__()
        self.url = self._served.url
        return self

    def __exit__(self, *exc):
        self._served.__exit__(*exc)

    def load(self, name, controller_type=GROUP_TYPE, *, running=False):
        """Load a controller without a request."""
        gains = {f"{joint}/{key}": 600.0 for joint in JOINTS for key in ("p", "d")}
        state = "running" if running else "initialized"
        self.controllers[name] = FakeController(name, controller_type, state, gains)

    def app(self):
        """Return the ASGI application."""
        routes = {
            ("GET", "/session"): self._session,
            ("GET", "/status"): self._status,
            ("GET", "/controllers"): self._list,
            ("POST", "/controllers"): self._load,
            ("POST", "/controllers/switch"): self._switch,
            ("DELETE", "/controllers/{name}"): self._unload,
            ("GET", "/controllers/{name}/gains"): self._gains,
            ("PATCH", "/controllers/{name}/gains"): self._set_gains,
            ("GET", "/controllers/{name}/command"): self._command_info,
            ("PUT", "/controllers/{name}/command"): self._command,
            ("GET", "/controllers/{name}/state"): self._controller_state,
            ("GET", "/controller-types"): self._types,
            ("GET", "/scene"): self._scene,
            ("GET", "/simulation"): self._simulated,
            ("PATCH", "/simulation"): self._change_simulation,
            ("POST", "/simulation/step"): self._step_simulation,
            ("POST", "/simulation/reset"): self._reset_simulation,
            ("GET", "/hardware"): self._hardware,
            ("POST", "/robots/error_recovery"): self._recover,
            ("POST", "/robots/{name}/user_stop"): self._user_stop,
            ("POST", "/stop"): self.stop,
            ("POST", "/stop/release"): self._release,
        }
        return Starlette(
            routes=[
                *(
                    Route("/api/v1" + path, self._checked(handler), methods=[method])
                    for (method, path), handler in routes.items()
                ),
                WebSocketRoute("/api/v1/streams/{topic:path}", self._stream),
            ]
        )

    def _checked(self, handler):
        async def endpoint(request):
            token = request.headers.get("authorization", "").removeprefix("Bearer ")
            if token not in {OPERATOR, VIEWER}:
                return problem(401, "unauthorized", "The token is wrong.")
            body = await request.body()
            content = json.loads(body) if body else {}
            self.requests.append((request.method, request.url.path, content))
            return handler(request.path_params.get("name", ""), content, token)

        return endpoint

    def _session(self, _name, _body, token):
        role = "operator" if token == OPERATOR else "viewer"
        return JSONResponse({"role": role})

    def _status(self, *_):
        return JSONResponse({
            "boot_id": self.boot_id,
            "epoch": self.epoch,
            "time": time.monotonic(),
            "cycle": 10,
            "robot_type": "franka_hw/FrankaHW",
            "robot_mode": "idle",
            "stop_state": self.stop_state,
            "stop_reason": "",
            "loop": LOOP,
            "simulation": self.simulation,
            "versions": {},
            "robots": self._arms(),
        })

    def _arms(self):
        return [arm_report(arm_id, mode) for arm_id, mode in self.arms.items()]

    def _recover(self, *_):
        self.arms = {
            arm_id: "idle" if mode == "reflex" else mode
            for arm_id, mode in self.arms.items()
        }
        return JSONResponse({"robots": self._arms(), "restarted": []})

    def _user_stop(self, name, body, _token):
        self.arms[name] = "user_stopped" if body["pressed"] else "idle"
        return JSONResponse(arm_report(name, self.arms[name]))

    def _list(self, *_):
        return JSONResponse({
            "controllers": [c.as_json() for c in self.controllers.values()]
        })

    def _load(self, _name, body, _token):
        if body["name"] in self.controllers:
            text = f"A controller '{body['name']}' is loaded already."
            return problem(409, "controller_exists", text, "Choose another name.")
        self.load(body["name"], body["type"])
        return JSONResponse(self.controllers[body["name"]].as_json(), 201)

    def _switch(self, _name, body, _token):
        for name in body.get("stop", []):
            self.controllers[name].state = "stopped"
        for name in body.get("start", []):
            self.controllers[name].state = "running"
        return JSONResponse({
            "ok": True,
            "started": body.get("start", []),
            "stopped": body.get("stop", []),
            "outcome": "committed",
            "failed": {},
            "jump": {},
            "cycle": 11,
            "dry_run": False,
        })

    def _unload(self, name, *_):
        return JSONResponse(self.controllers.pop(name).as_json())

    def _gains(self, name, *_):
        controller = self.controllers.get(name)
        if controller is None:
            return problem(404, "controller_not_found", f"No controller '{name}'.")
        return JSONResponse({
            "values": controller.gains,
            "schema": {key: gain_schema(key) for key in controller.gains},
            "revision": 1,
            "etag": '"1"',
        })

    def _set_gains(self, name, body, _token):
        gains = self.controllers[name].gains
        previous = dict(gains)
        gains.update(body["values"])
        return JSONResponse({
            "values": gains,
            "previous": previous,
            "revision": 2,
            "cycle": 12,
        })

    def _elements(self, name):
        kind = self.controllers[name].type
        if "CartesianJog" in kind:
            return TWIST, "m/s", 0.3, [0.0] * 6
        if "CartesianStreaming" in kind:
            return POSE, "m", 2.0, self.pose
        return JOINTS, "rad", 2.8, self.desired

    def _command_info(self, name, *_):
        names, unit, bound, last = self._elements(name)
        elements = [
            {"name": each, "unit": unit, "minimum": -bound, "maximum": bound}
            for each in names
        ]
        return JSONResponse({"elements": elements, "last": last})

    def _controller_state(self, name, *_):
        names, _, _, last = self._elements(name)
        return JSONResponse({
            "stamp": 0.0,
            "name": list(names),
            **dict.fromkeys(("desired", "actual", "error", "output"), last),
            "published": {"state": {"message": self.message}},
        })

    def _command(self, name, body, _token):
        if body.get("epoch", self.epoch) != self.epoch:
            return problem(409, "stale_epoch", "A stop came since.", "Look again.")
        if self._elements(name)[0] is not JOINTS:
            # An arm that says what is in its way waits there.
            if len(body["command"]) == len(POSE) and not self.message:
                self.pose = body["command"]
            return JSONResponse({"epoch": self.epoch}, 202)
        told = zip(body["command"], self.desired, strict=False)
        self.desired = [old if new is None else new for new, old in told]
        self.positions = list(self.desired)
        return JSONResponse({"epoch": self.epoch}, 202)

    def _types(self, *_):
        jog = "franka_controllers/CartesianJogController"
        kinds = [GROUP_TYPE, jog, "joint_state_controller/JointStateController"]
        return JSONResponse({
            "controller_types": [
                {"type": kind, "base_class": "Controller", "description": ""}
                for kind in kinds
            ]
        })

    def _scene(self, *_):
        return JSONResponse({"objects": self.objects})

    def _simulated(self, *_):
        return JSONResponse(self.simulation)

    def _change_simulation(self, _name, body, _token):
        self.simulation = {**self.simulation, **body}
        return self._simulated()

    def _step_simulation(self, _name, body, _token):
        time = self.simulation["time"] + 0.001 * body["n"]
        return self._change_simulation("", {"time": time}, "")

    def _reset_simulation(self, *_):
        return self._change_simulation("", {"time": 0.0}, "")

    def _hardware(self, *_):
        return JSONResponse(HARDWARE)

    def stop(self, *_):
        self.stop_state = "stopped"
        self.epoch += 1
        for controller in self.controllers.values():
            controller.state = "stopped"
        return self._stop_answer()

    def _release(self, _name, body, _token):
        self.stop_state = "armed" if body.get("arm") else "released"
        return self._stop_answer()

    def _stop_answer(self):
        return JSONResponse({
            "state": self.stop_state,
            "reason": "",
            "epoch": self.epoch,
        })

    async def _stream(self, socket):
        topic = socket.path_params["topic"]
        await socket.accept()
        frame = {"seq": 0, "epoch": self.epoch, "boot_id": self.boot_id, "stamp": 0.0}
        await socket.send_json({"topic": "hello", **frame})
        rate = float(socket.query_params.get("rate", 30))
        try:
            while True:
                frame["seq"] += 1
                frame["stamp"] = stamp = time.monotonic()
                data = self._sample(topic, stamp)
                await socket.send_json({"topic": topic, **frame, "data": data})
                await asyncio.sleep(1.0 / rate)
        except (WebSocketDisconnect, RuntimeError):
            return  # The reader has gone.

    def _sample(self, topic, stamp):
        zeros = [0.0] * len(JOINTS)
        if topic == "joint_states":
            return {
                "stamp": stamp,
                "name": JOINTS,
                "position": self.positions,
                "velocity": zeros,
                "effort": zeros,
            }
        name = topic.removeprefix("controller_state/")
        names, _, _, last = self._elements(name)
        if names is not JOINTS:
            keys = ("desired", "actual", "error", "output")
            return {"stamp": stamp, "name": list(names), **dict.fromkeys(keys, last)}
        return {
            "stamp": stamp,
            "name": JOINTS,
            "desired": self.desired,
            "actual": self.positions,
            "error": zeros,
            "output": zeros,
        }
