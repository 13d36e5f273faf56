"""Messages of a browser that reach Viser."""

import msgspec
import pytest

from station.ui.gateway.viser_relay import may_pass
from station.ui.sessions.sessions import Role

CAMERA = {"type": "ViewerCameraMessage", "wxyz": [1, 0, 0, 0]}
VALUE = {"type": "GuiUpdateMessage", "uuid": "a", "updates": {"value": 1.0}}


@pytest.mark.parametrize(
    ("message", "role", "passes"),
    [
        (CAMERA, Role.VIEWER, True),
        (CAMERA, Role.OPERATOR, True),
        (VALUE, Role.OPERATOR, True),
        (VALUE, Role.VIEWER, False),
        ({"type": "GuiButtonHoldMessage", "uuid": "a"}, Role.OPERATOR, True),
        ({"type": "GuiButtonHoldMessage", "uuid": "a"}, Role.VIEWER, False),
        ({"type": "TransformControlsUpdateMessage"}, Role.OPERATOR, True),
        ({"type": "TransformControlsUpdateMessage"}, Role.VIEWER, False),
        ({"type": "SceneNodeDragMessage"}, Role.OPERATOR, True),
        ({"type": "SceneNodeDragMessage"}, Role.VIEWER, False),
        ({"type": "ShareUrlRequest"}, Role.OPERATOR, False),
        ({"type": "FileTransferStartUpload"}, Role.OPERATOR, False),
        ({**VALUE, "updates": {"update_cb": []}}, Role.OPERATOR, False),
        ({**VALUE, "updates": None}, Role.OPERATOR, False),
        ([CAMERA], Role.OPERATOR, False),
    ],
)
def test_frames_pass_by_kind_and_role(message, role, passes):
    assert may_pass(msgspec.msgpack.encode(message), role) is passes


def test_malformed_frames_do_not_pass():
    assert not may_pass(b"\xc1", Role.OPERATOR)
