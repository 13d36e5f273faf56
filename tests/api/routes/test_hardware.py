"""The robot over HTTP."""


def test_interfaces_and_claims(client):
    client.load_controller("spring", "test/Spring", {"joint": "j"})
    client.switch_controllers(start=["spring"])

    hardware = client.hardware()

    interfaces = {interface.name: interface for interface in hardware.interfaces}
    effort = interfaces["hardware_interface::EffortJointInterface"]
    assert [(r.name, r.claimed_by) for r in effort.resources] == [("j", ["spring"])]
    assert hardware.limits == []
    assert hardware.clamps == client.status().clamps == []
