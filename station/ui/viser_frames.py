"""Decide which messages of a browser reach Viser.

Viser trusts its pages: any of them may ask for a public tunnel, upload files or set
any attribute of a widget's state. The gateway passes on what a page needs, by role.
"""

import msgspec

from station.ui.sessions import Role

_CAMERA = "ViewerCameraMessage"
_WIDGET_VALUE = "GuiUpdateMessage"
_VIEWER_MESSAGES = frozenset({_CAMERA})
_OPERATOR_MESSAGES = frozenset({
    _CAMERA,
    _WIDGET_VALUE,
    "GuiButtonHoldMessage",
    "TransformControlsUpdateMessage",
    "TransformControlsDragStartMessage",
    "TransformControlsDragEndMessage",
    "SceneNodeDragMessage",
})


def may_pass(frame: bytes, role: Role) -> bool:
    """Return whether a frame from a browser with this role may reach Viser.

    Args:
        frame: One binary WebSocket message, msgpack as Viser's page sends it.
        role: Role of the browser's session.

    Returns:
        True for the camera's pose from everybody, and for widget values, held
        buttons and dragged frames from an operator; False for everything else,
        malformed frames included.
    """
    try:
        message = msgspec.msgpack.decode(frame)
    except (msgspec.DecodeError, UnicodeDecodeError):
        return False
    if not isinstance(message, dict):
        return False
    kind = message.get("type")
    allowed = _OPERATOR_MESSAGES if role is Role.OPERATOR else _VIEWER_MESSAGES
    if kind not in allowed:
        return False
    if kind == _WIDGET_VALUE:
        updates = message.get("updates")
        return isinstance(updates, dict) and set(updates) == {"value"}
    return True
